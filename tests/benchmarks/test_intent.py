"""The network of contacts is measured on people from whom it has not learnt."""

from benchmarks.intent.takes import simulated

from action_fusion.intent.contact_network import shipped_network
from actum_model_trainer.foreseeing.said import said_by
from actum_model_trainer.foreseeing.scoring import ahead, before


def test_the_network_that_comes_with_actum_foresees_contacts_of_people_it_has_not_seen() -> None:
    said = [said_by(shipped_network(), take) for take in simulated([201], 9)]
    assert before(said, 0.5).right >= 0.8
    assert ahead(said, 0.8).median_s >= 0.3
