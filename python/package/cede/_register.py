"""What others are told of when `cede` is imported: environments, and how a contract travels."""

import copyreg

from ._cede import Contract

ENVIRONMENT = "cede/Encounter-v0"


def register() -> None:
    """Register `cede/Encounter-v0`, once, and contracts with `pickle`."""
    import gymnasium

    copyreg.pickle(Contract, _reduced)

    if ENVIRONMENT not in gymnasium.registry:
        gymnasium.register(
            ENVIRONMENT,
            entry_point="cede.envs:EncounterEnv",
            vector_entry_point="cede.envs:EncounterVectorEnv",
        )


def _reduced(contract: Contract) -> tuple:
    return _contract, (contract.to_toml(),)


def _contract(toml: str) -> Contract:
    return Contract.from_toml(toml)
