"""Marks without a stamp get that of their own segment's answer, however often its name is used again."""

from hypothesis import given
from hypothesis import strategies as st

from actum.messages import Action
from actum_examples.unstamped_marks import Placed, UnstampedMarks
from empty_messages import action, mark

ORDERS = (("start", "end", "answer"), ("start", "answer", "end"))
USES = st.lists(st.tuples(st.sampled_from(ORDERS), st.booleans(), st.booleans()), min_size=1, max_size=5)
"""For each use of a name: in which order its messages come, and whether its start and its end have a stamp."""


@given(USES, st.data())
def test_each_mark_gets_the_stamp_of_its_own_segment(
    uses: list[tuple[tuple[str, ...], bool, bool]], data: st.DataObject
) -> None:
    """Sessions follow each other at once, and answers of before come again at any time."""
    marks, placed, answers, expected = UnstampedMarks(), list[Placed](), list[Action](), list[tuple[str, str, int]]()
    for number, (order, start_stamped, end_stamped) in enumerate(uses):
        bounds = {"start": 100 * number, "end": 100 * number + 50}
        stamped = {"start": start_stamped, "end": end_stamped}
        for what in order:
            if answers and data.draw(st.booleans()):
                placed += marks.answer(data.draw(st.sampled_from(answers)), number)
            if what == "answer":
                answers.append(action(bounds["start"], bounds["end"], session_id=str(number)))
                placed += marks.answer(answers[-1], number)
                continue
            comes = mark(what, bounds[what] if stamped[what] else None, label=str(number))
            expected += [] if stamped[what] else [(str(number), what, bounds[what])]
            placed += marks.receive(comes, number)
    placed += marks.close()
    found = [(each.label, each.kind, each.stamp_ns) for each, _ in placed]
    assert sorted(found) == sorted(expected)
