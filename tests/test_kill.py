"""Runs that are killed leave whole files, and end as if they had not been."""

from warpsph.quality.torture import kill
from warpsph.quality.torture.trial import Means


def test_the_short_trial_holds(tmp_path):
    found = kill.run(Means(tmp_path, True, lambda line: None))
    assert not found.failed
    assert [row[1] for row in found.rows] == ["2"] and int(found.rows[0][-1]) >= 1
