# Pinocchio's names come from compiled modules that ship no stubs: every one of them counts as Any.
from typing import Any

def __getattr__(name: str) -> Any: ...
