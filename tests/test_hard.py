"""Hard cases at default settings, one fact each: the expected result occurs, with the same bits on any number of threads, on every
instruction set and when a run is resumed half way. The table is tests/hard/table.py. Speaks TAP.
`test_hard.py PROGRAM some words` runs the cases with one of the words in their name."""
from program import *  # noqa: F403
from hard import case, page, table


def test_of(one, sets):
    def test(folder):
        seen, figures = case.watch(one, folder)
        print(f"# {one.name}: {figures}")
        if sets:
            case.same_everywhere(one, seen, sets)
    test.__name__ = one.name
    return test


def the_page_lists_every_case(folder):
    with open(page.PAGE, encoding="utf-8") as file:
        text = file.read()
    for one in table.CASES:
        for said in (page.reported(one), page.kept(one)):
            assert said in text, f"docs/evidence/hard-cases.md does not say: {said}"
    rows = sum(line.startswith("| ") and not line.startswith(("| case |", "| ---")) for line in text.splitlines())
    assert rows == len(table.CASES), f"{rows} rows, {len(table.CASES)} cases: tests/hard/page.py writes the page"


def there_are_at_least_fifty(folder):
    assert len(table.CASES) >= 50
    for one in table.CASES:
        assert one.hard and one.should and one.without, f"{one.name}: nothing said"
        assert not one.more or os.path.exists(os.path.join(os.path.dirname(SCENES), one.more)), one.more


if __name__ == "__main__":
    # Under a sanitizer a run takes several times as long, and each case is run once.
    words, sets = sys.argv[2:], [] if SANITIZED else case.present_sets()
    for one in table.CASES:
        if not words or any(word in one.name for word in words):
            fact(test_of(one, sets))
    if not words:
        fact(there_are_at_least_fifty)
        fact(the_page_lists_every_case)
    sys.exit(main())
