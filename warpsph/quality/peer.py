"""Another code to be measured beside this one: a command that ends its output with one line of JSON."""

import json
import shlex
import subprocess
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from warpsph.messages import measuring


@dataclass
class Peer:
    """Another code's command, which ends its output with one line of JSON.

    Attributes:
        command: The command.
        ns: Its ``ns_per_particle_step``, one for each repetition.
        facts: All that it printed the last time.
    """

    command: str
    ns: list[float] = field(default_factory=list)
    facts: dict[str, Any] = field(default_factory=dict)

    def measure(self) -> None:
        """Run it once.

        Raises:
            InputError: There is no such command, or it does not print what is needed.
            RunError: It failed.
        """
        try:
            done = subprocess.run(shlex.split(self.command), capture_output=True, text=True, check=False)
        except (OSError, ValueError, IndexError) as error:  # no such file, open quotes, no words
            raise measuring.peer_not_run(self.command, error) from error
        last = (done.stdout.strip().splitlines() or [""])[-1]
        if done.returncode:
            said = (done.stderr.strip().splitlines() or [last])[-1]
            raise measuring.peer_failed(self.command, done.returncode, said)
        try:
            self.facts = json.loads(last)
            self.ns.append(float(self.facts["ns_per_particle_step"]))
            self.facts["threads"] = int(self.facts.get("threads", self.facts.get("ranks")))
        except (ValueError, KeyError, TypeError) as error:
            raise measuring.peer_unclear(self.command, last) from error

    def cells(self) -> list[str]:
        """What it is and what it took, for a table."""
        facts = self.facts
        name = f"{facts.get('code', shlex.split(self.command)[0])} {facts.get('version', '')}".strip()
        head = [name, *(str(facts.get(key, "?")) for key in ("particles", "neighbours", "threads", "steps"))]
        return [*head, f"{median(self.ns):.4g}", f"{min(self.ns):.4g}", f"{max(self.ns):.4g}"]
