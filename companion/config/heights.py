"""How high a configuration may have a drone fly."""

from typing import Annotated

from pydantic import Field

FlownHeight = Annotated[float, Field(gt=0.0, le=120.0)]
"""Above the ground, or above the pad, m. Without a permit of its own no drone flies higher: regulation (EU) 2019/947,
UAS.OPEN.010 (120 m), and 14 CFR 107.51 (400 ft, 122 m)."""
