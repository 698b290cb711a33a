"""Make docs/pictures/set-*.jpg: the contact sheet of each stimulus set in a folder.

    python -m docs.screenshots_sets DIR

DIR holds one folder a set, as `python -m benchmarks.stimulus_sets --full --keep DIR` leaves them.
"""

import sys
from pathlib import Path
from typing import Final

import stimuli
from algorithms.images import write_picture
from stimuli.contact_sheet import draw_contact_sheet
from stimuli.manifest import MANIFEST_NAME

PICTURES: Final = Path(__file__).parent / "pictures"
WIDTH_PX: Final = 1280
COLUMNS: Final = {"still-life": 3, "fog": 2, "fog-methods": 5, "caustics": 10, "texture": 8}


def main() -> None:
    """Save the contact sheet of each set."""
    for manifest in sorted(Path(sys.argv[1]).glob(f"*/{MANIFEST_NAME}")):
        made = stimuli.load(manifest)
        columns = COLUMNS.get(made.name, 10)
        sheet = draw_contact_sheet(made, columns=columns, thumbnail_px=WIDTH_PX // columns - 12)
        write_picture(PICTURES / f"set-{made.name}.jpg", sheet)


if __name__ == "__main__":
    main()
