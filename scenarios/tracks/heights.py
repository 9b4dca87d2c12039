"""The height of a road along its length, in closed form.

Grades are heights per horizontal length; where a grade changes it does so evenly, so a crest or a dip is a parabola,
as road design has it (AASHTO Green Book, chapter 3.4.6).
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise


@dataclass(frozen=True, slots=True, kw_only=True)
class Slope:
    """A grade (height per horizontal length) that sets in linearly over `transition_m` from `start_s_m` on."""

    grade: float = 0.0
    start_s_m: float = 0.0
    transition_m: float = 10.0

    def at(self, s_m: float) -> tuple[float, float, float]:
        """Return height (m), grade and change of grade (1/m) at arc length `s_m`."""
        along_m = s_m - self.start_s_m
        if along_m <= 0.0 or self.grade == 0.0:
            return 0.0, 0.0, 0.0
        if along_m < self.transition_m:
            change_per_m = self.grade / self.transition_m
            return 0.5 * change_per_m * along_m**2, change_per_m * along_m, change_per_m
        return self.grade * (along_m - 0.5 * self.transition_m), self.grade, 0.0


FLAT = Slope()


@dataclass(frozen=True, slots=True, kw_only=True)
class GradeLine:
    """Grades at places along the road, even changes between them; the first and the last go on for ever.

    Attributes:
        starts_m: arc lengths of the places, ascending.
        grades: there.
        heights_m: there; 0 at the road's first point.
    """

    starts_m: tuple[float, ...]
    grades: tuple[float, ...]
    heights_m: tuple[float, ...]

    def at(self, s_m: float) -> tuple[float, float, float]:
        """Return height (m), grade and change of grade (1/m) at arc length `s_m`."""
        i = bisect_right(self.starts_m, s_m) - 1
        if i < 0:
            return self.heights_m[0] + self.grades[0] * (s_m - self.starts_m[0]), self.grades[0], 0.0
        along_m, grade, change_per_m = s_m - self.starts_m[i], self.grades[i], 0.0
        if i + 1 < len(self.starts_m):
            change_per_m = (self.grades[i + 1] - grade) / (self.starts_m[i + 1] - self.starts_m[i])
        height_m = self.heights_m[i] + (grade + 0.5 * change_per_m * along_m) * along_m
        return height_m, grade + change_per_m * along_m, change_per_m


def grade_line(grades: Sequence[tuple[float, float]]) -> GradeLine:
    """Return the height of a road with `grades`, (arc length in m, grade), in the order of the places.

    Raises:
        ValueError: no place, or places that do not ascend.
    """
    if not grades or any(after_m <= before_m for (before_m, _), (after_m, _) in pairwise(grades)):
        raise ValueError(f"grades need ascending places, not {list(grades)}")
    heights_m = [grades[0][0] * grades[0][1]]
    for (before_m, grade), (after_m, next_grade) in pairwise(grades):
        heights_m.append(heights_m[-1] + 0.5 * (grade + next_grade) * (after_m - before_m))
    starts_m, values = zip(*grades, strict=True)
    return GradeLine(starts_m=starts_m, grades=values, heights_m=tuple(heights_m))
