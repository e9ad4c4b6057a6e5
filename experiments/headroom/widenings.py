"""The log of widenings: what was changed in a world because choosing was worth too little in it, at most twice.

Every figure is headroom over SBS by rule on maps drawn for the study, none of them of a split: 24 to 60 maps, so that
intervals are some ten points wide to either side.
"""

_BOX = (
    "ξ_max and ξ_min up to 4, for the best had lain at 1.5; limits from 1 on: with twelve way-points past corridors or "
    "scattered discs, 200 to 800 cycles, {}"
)
_WORLDS = (
    "four way-points beside twelve, and with them 5 to 80 bees for 20 to 1,000 cycles; tried beside these: narrow "
    "gates, dense discs, ends anywhere, three and five way-points: {}"
)

WIDENINGS: dict[str, tuple[str, ...]] = {
    "Bee": (_BOX.format("9 and 8 %"), _WORLDS.format("-18 to 23 % in 15 mixtures, 5 % in the median")),
    "TabuBee": (_BOX.format("16 and 8 %"), _WORLDS.format("0 to 27 % in 8 mixtures, 5 % in the median")),
}
