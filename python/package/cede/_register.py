"""Names the environments to Gymnasium when `cede` is imported."""

ENVIRONMENT = "cede/Encounter-v0"


def register() -> None:
    """Register `cede/Encounter-v0`, once."""
    import gymnasium

    if ENVIRONMENT not in gymnasium.registry:
        gymnasium.register(
            ENVIRONMENT,
            entry_point="cede.envs:EncounterEnv",
            vector_entry_point="cede.envs:EncounterVectorEnv",
        )
