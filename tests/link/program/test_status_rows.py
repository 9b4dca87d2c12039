"""A landing's status and the links as rows of words."""

from link.program.status_rows import link_rows, number


def test_rows_of_the_links_tell_each_count_in_its_place() -> None:
    rows = dict(link_rows(received=11, sent=7, lost=5, bad_bytes=3, bad_payloads=2))
    assert rows == {"messages in, out, lost": "11, 7, 5", "bad bytes, payloads": "3, 2"}


def test_number_that_rounds_to_nothing_has_no_sign() -> None:
    assert number(-0.001, "s") == "0.00 s"
