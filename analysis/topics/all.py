"""Every topic, in the order of the command line."""

from typing import Any

from analysis.topics.company.topic import COMPANY
from analysis.topics.corrections.topic import CORRECTIONS
from analysis.topics.errors.topic import ERRORS
from analysis.topics.insulators.topic import INSULATORS
from analysis.topics.machines.topic import MACHINES
from analysis.topics.published.topic import PUBLISHED
from analysis.topics.topic import Topic
from analysis.topics.verification.topic import VERIFICATION

_WITH_SCENES: tuple[Topic[Any, Any], ...] = (ERRORS, COMPANY, MACHINES, INSULATORS)
TOPICS: tuple[Topic[Any, Any], ...] = (VERIFICATION, *_WITH_SCENES, CORRECTIONS, PUBLISHED)
