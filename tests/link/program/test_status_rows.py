"""A landing's status and the links as rows of words."""

from link.program.status_rows import link_rows


def test_rows_of_the_links_tell_each_count_in_its_place() -> None:
    rows = dict(link_rows(received=11, sent=7, lost=5, bad_bytes=3, bad_payloads=2))
    assert rows == {"messages in, out, lost": "11, 7, 5", "bad bytes, payloads": "3, 2"}
