"""Jobs of the proof on Dask: each stage a campaign of its own below the run's folder.

Workers elsewhere must see the run's folder and this repository under the same paths.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
from dask.distributed import Client

from campaign import Campaign, Job, Row
from campaign_cli import console
from peer_library import ROOT


def by_value(function: Callable[[Job], list[Row]]) -> Callable[[Job], list[Row]]:
    """The function by its name and where this repository is.

    Schedulers unpickle jobs too and cannot import this package; workers may find an old copy of it
    among what was once sent to them.
    """
    module, name, root = function.__module__, function.__name__, str(ROOT)

    def call(job: Job) -> list[Row]:
        import importlib
        import sys

        if root in sys.path:
            sys.path.remove(root)
        sys.path.insert(0, root)
        rows: list[Row] = getattr(importlib.import_module(module), name)(job)
        return rows

    return call


def run_stage(
    folder: Path,
    stage: str,
    settings: Mapping[str, Any],
    function: Callable[[Job], list[Row]],
    jobs: Mapping[str, Job],
    client: Client,
) -> pd.DataFrame:
    """All rows of a stage, run where they are not there yet.

    Raises:
        CampaignError: jobs failed, or the folder is of other settings.
    """
    console.print(f"[bold]{stage}[/]", highlight=False)
    return Campaign(folder / stage, settings).run(by_value(function), jobs, client, console)
