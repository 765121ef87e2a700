"""Every topic of set-ups, in the order of the command line."""

from __future__ import annotations

from typing import Any

from analysis.topics.company.topic import COMPANY
from analysis.topics.errors.topic import ERRORS
from analysis.topics.insulators.topic import INSULATORS
from analysis.topics.machines.topic import MACHINES
from analysis.topics.topic import Topic

TOPICS: tuple[Topic[Any, Any], ...] = (ERRORS, COMPANY, MACHINES, INSULATORS)
