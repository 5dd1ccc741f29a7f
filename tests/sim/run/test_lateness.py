"""Spells in which the loop is late: counted whole, told once each."""

from pendant.event_table import render
from pendant.events.event import Event, Kind
from sim.run.lateness import Lateness


def test_a_spell_is_one_event_with_its_worst_and_how_often() -> None:
    spell = Lateness()
    for now, late in ((100.0, 0.08), (104.0, 0.248), (112.0, 0.06), (120.0, 0.061), (121.0, 0.06), (125.0, 0.07), (127.0, 0.06)):
        assert not spell.over(now)
        spell.drop(late, now)
    assert not spell.over(136.9)
    assert spell.over(137.0), "10 s of calm"
    event = spell.tell(9000)
    assert event == Event(Kind.OVERRUN, 9000, {"late": 248.0, "lost": 0.639, "often": "7 times in 27 s"})
    assert render(event) == (
        "Simulation late 7 times in 27 s, by 248 ms at worst",
        "The machine is busy; 0.6 s were dropped.",
    )


def test_the_next_spell_counts_anew() -> None:
    spell = Lateness()
    spell.drop(0.3, 5.0)
    spell.drop(0.2, 6.0)
    spell.tell(1)
    assert not spell.over(1e6), "there is none"
    spell.drop(0.1, 50.0)
    assert not spell.over(59.9)
    assert spell.over(60.0)
    assert render(spell.tell(2))[0] == "Simulation late once, by 100 ms at worst"


def test_a_spell_without_an_end_is_told_once_a_minute() -> None:
    spell, told = Lateness(), []
    for second in range(601):
        if spell.over(float(second)):
            told.append(spell.tell(second))
        spell.drop(0.1, float(second))
    assert [event.tick for event in told] == list(range(60, 601, 60))
    assert {event.values["often"] for event in told} == {"60 times in 59 s"}
