"""The words people use for things, colours, materials, sizes, places and actions. Data only.

Keys are cleaned words or phrases (lower case, singular, single spaces). What a noun may denote comes in two strengths:
`NOUNS` gives the categories it names, `LOOSE` those that people also call so when there is nothing nearer.
"""

from __future__ import annotations

from agent.goal import Extreme, Measure, RelationWord, Side

ALL_OF = ("all", "all of them", "them all", "all of it", "all of these", "all of those", "every one of them")
"""Said of everything there is, where nothing is held."""
BOTH_OF = ("both", "both of them", "them both", "both of these", "both of those")
"""Said of the two things that there are."""
NOUNS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("cup", "teacup", "coffee cup", "tea cup", "ceramic cup", "cuppa"), ("cup",)),
    **dict.fromkeys(("mug", "coffee mug", "tea mug", "beaker"), ("mug",)),
    "apple": ("apple",),
    **dict.fromkeys(("bottle", "water bottle", "plastic bottle", "flask", "pet bottle"), ("bottle",)),
    "banana": ("banana",),
    **dict.fromkeys(("bowl", "ceramic bowl", "cereal bowl", "soup bowl", "salad bowl"), ("bowl",)),
    **dict.fromkeys(("cube", "wood cube", "wooden cube", "dice", "die"), ("cube",)),
    **dict.fromkeys(("vase", "flower vase", "glass vase"), ("vase",)),
    **dict.fromkeys(("wine glass", "wineglass", "stemmed glass", "goblet", "stemware"), ("wine_glass",)),
    "glass": ("wine_glass",),
    **dict.fromkeys(("screwdriver", "screw driver", "driver"), ("screwdriver",)),
    **dict.fromkeys(
        (
            "smartphone",
            "smart phone",
            "phone",
            "mobile",
            "mobile phone",
            "cell phone",
            "cellphone",
            "telephone",
            "iphone",
        ),
        ("smartphone",),
    ),
    **dict.fromkeys(("tennis ball", "ball"), ("tennis_ball",)),
    **dict.fromkeys(("block", "toy block", "building block", "brick", "toy brick", "lego", "lego brick"), ("block",)),
    **dict.fromkeys(("box", "carton", "cardboard box", "package", "parcel"), ("box",)),
    **dict.fromkeys(("pen", "ballpoint", "biro", "marker", "ballpoint pen"), ("pen",)),
    **dict.fromkeys(("key", "house key", "door key"), ("key",)),
    "fruit": ("apple", "banana"),
    **dict.fromkeys(("tool", "hand tool"), ("screwdriver",)),
    **dict.fromkeys(("glassware",), ("wine_glass", "vase")),
    **dict.fromkeys(("dish", "crockery", "dishes"), ("bowl", "cup", "mug")),
    "drinkware": ("cup", "mug", "wine_glass"),
    "toy": ("block", "cube", "tennis_ball"),
    **dict.fromkeys(("electronics", "device", "gadget"), ("smartphone",)),
    **dict.fromkeys(("container", "vessel"), ("cup", "mug", "bowl", "bottle", "vase", "wine_glass", "box")),
    "food": ("apple", "banana"),
}
"""Noun -> categories it names."""

LOOSE: dict[str, tuple[str, ...]] = {
    "cup": ("mug",),
    "teacup": ("mug",),
    "coffee cup": ("mug",),
    "mug": ("cup",),
    "coffee mug": ("cup",),
    "block": ("cube",),
    "toy block": ("cube",),
    "brick": ("cube", "block"),
    "cube": ("block",),
    "dice": ("block",),
    "box": ("cube", "block"),
    "glass": ("vase",),
    "pen": (),
}
"""Noun -> categories that it may also mean where nothing of the first kind is seen."""

GENERIC = ("thing", "object", "item", "one", "stuff", "something", "anything", "everything", "piece", "toy thing")
"""Nouns that fit every object."""

UNSEEN_NOUNS = (
    "teapot", "kettle", "plate", "fork", "knife", "spoon", "book", "laptop", "keyboard", "mouse", "can", "jar", "thermos",
    "hammer", "wrench", "scissors", "brush", "remote", "remote control", "lamp", "candle", "egg", "orange", "lemon", "pear", "shoe", "hat",
    "car", "dog", "cat", "elephant", "unicorn", "dragon", "person", "watch", "wallet", "coin", "pan", "pot", "towel",
    "bag", "plant", "flower", "bulb", "sponge", "notebook", "charger", "cable", "camera", "clock", "comb", "doll",
    "guitar", "pillow", "ruler", "stapler", "tape", "toothbrush", "umbrella", "pizza", "cake", "sandwich", "cookie",
    "bell", "belt", "bill", "bull", "bean", "bead", "bolt", "card", "cart", "cord", "corn", "crab", "coat", "peg", "mask", "vest",
    "pill", "petal", "cable", "glove", "cloth", "blanket", "bowtie", "applesauce", "tennis racket", "racket", "mirror",
    "bread", "chair", "window", "door", "wall", "moon", "tower", "car key", "tomato", "potato", "carrot", "peach", "melon",
    "spatula", "ladle", "pliers", "screw", "nail", "teddy bear", "teddy", "plush", "figurine", "saucer", "tumbler",
)  # fmt: skip
"""Everyday nouns that we know as words but not as categories: they are taken at their word, never corrected as typos."""

COLOURS: dict[str, tuple[str, ...]] = {
    "red": ("red", "orange", "pink", "brown"),
    "crimson": ("red", "pink"),
    "orange": ("orange", "red", "yellow", "brown"),
    "yellow": ("yellow", "orange"),
    "golden": ("yellow", "orange", "brown"),
    "green": ("green", "turquoise", "yellow"),
    "turquoise": ("turquoise", "green", "blue"),
    "teal": ("turquoise", "green", "blue"),
    "cyan": ("turquoise", "blue"),
    "blue": ("blue", "turquoise", "purple"),
    "navy": ("blue", "black"),
    "purple": ("purple", "pink", "blue"),
    "violet": ("purple", "pink", "blue"),
    "pink": ("pink", "red", "purple"),
    "magenta": ("pink", "purple"),
    "brown": ("brown", "orange", "red"),
    "beige": ("brown", "white", "yellow"),
    "white": ("white", "grey"),
    "black": ("black", "grey"),
    "grey": ("grey", "white", "black"),
    "gray": ("grey", "white", "black"),
    "silver": ("grey", "white"),
}
"""Colour word -> names that perception may give it, the best first; the later ones count only where no better fits."""

MATERIALS: dict[str, str] = {
    "glass": "glass", "plastic": "plastic", "wooden": "wood", "wood": "wood", "metal": "metal", "metallic": "metal",
    "steel": "metal", "iron": "metal", "aluminium": "metal", "aluminum": "metal", "ceramic": "ceramic",
    "porcelain": "ceramic", "china": "ceramic", "clay": "ceramic", "fabric": "fabric", "cloth": "fabric", "felt": "fabric",
    "paper": "paper", "cardboard": "paper", "foam": "foam", "organic": "organic", "edible": "organic", "transparent": "glass", "see-through": "glass", "crystal": "glass",
}  # fmt: skip

SHAPES: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("round", "spherical"), ("sphere", "cylinder", "bowl")),
    **dict.fromkeys(("flat",), ("plate",)),
    **dict.fromkeys(("square", "cubic", "rectangular", "boxy"), ("box",)),
    **dict.fromkeys(("cylindrical",), ("cylinder",)),
    **dict.fromkeys(("elongated", "slim", "stick-like"), ("bar",)),
}
"""Adjective -> geometric families of `kb.percept.Shape` that it fits."""

QUALITIES: dict[str, str] = {
    **dict.fromkeys(("big", "large", "huge", "bigger", "larger"), "big"),
    **dict.fromkeys(("small", "little", "tiny", "smaller", "mini"), "small"),
    **dict.fromkeys(("tall", "taller", "high", "long", "longer"), "tall"),
    **dict.fromkeys(("short", "shorter", "low"), "short"),
    **dict.fromkeys(("fragile", "delicate", "breakable"), "fragile"),
    **dict.fromkeys(("heavy", "heavier"), "heavy"),
    **dict.fromkeys(("light", "lighter", "lightweight"), "light"),
}
"""Adjective -> quality that settles between candidates."""

EXTREMES: dict[str, Extreme] = {
    **dict.fromkeys(("biggest", "largest", "most large"), "biggest"),
    **dict.fromkeys(("smallest", "tiniest", "littlest"), "smallest"),
    **dict.fromkeys(("tallest", "highest", "longest"), "tallest"),
    **dict.fromkeys(("shortest", "lowest"), "shortest"),
    **dict.fromkeys(("widest", "broadest", "thickest"), "widest"),
    **dict.fromkeys(("thinnest", "narrowest", "slimmest"), "thinnest"),
    **dict.fromkeys(("heaviest",), "heaviest"),
    **dict.fromkeys(("lightest",), "lightest"),
    **dict.fromkeys(("most fragile", "most delicate", "most breakable"), "most_fragile"),
    **dict.fromkeys(("least fragile", "sturdiest", "toughest", "most robust", "least delicate"), "least_fragile"),
    **dict.fromkeys(("leftmost", "left most"), "leftmost"),
    **dict.fromkeys(("rightmost", "right most"), "rightmost"),
    **dict.fromkeys(("nearest", "closest", "front most", "frontmost"), "nearest"),
    **dict.fromkeys(("farthest", "furthest", "rearmost", "most distant"), "farthest"),
    **dict.fromkeys(("middle", "central", "centre", "center"), "middle"),
}
"""Superlative -> what it singles out."""

ORDINALS: dict[str, int] = {
    "first": 1, "1st": 1, "second": 2, "2nd": 2, "third": 3, "3rd": 3, "fourth": 4, "4th": 4, "fifth": 5, "5th": 5,
    "sixth": 6, "6th": 6, "last": -1,
}  # fmt: skip

NUMBERS: dict[str, int] = {
    "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10, "both": 2,
    "couple of": 2,
}  # fmt: skip

SIDES: dict[str, Side] = {
    "left": "left", "right": "right", "front": "front", "back": "back", "rear": "back", "middle": "middle",
    "centre": "middle", "center": "middle", "far": "back",
}  # fmt: skip

RELATIONS: tuple[tuple[str, RelationWord], ...] = (
    ("to the left of", "left_of"), ("on the left of", "left_of"), ("left of", "left_of"), ("left from", "left_of"),
    ("to the right of", "right_of"), ("on the right of", "right_of"), ("right of", "right_of"),
    ("on the left side of", "left_of"), ("on the right side of", "right_of"),
    ("in front of", "in_front_of"), ("before", "in_front_of"), ("behind", "behind"), ("at the back of", "behind"), ("to the rear of", "behind"), ("on the other side of", "behind"), ("at the front of", "in_front_of"), ("in back of", "behind"),
    ("hidden by", "behind"), ("hidden behind", "behind"), ("occluded by", "behind"),
    ("nearest to", "nearest_to"), ("closest to", "nearest_to"), ("nearest", "nearest_to"), ("closest", "nearest_to"),
    ("right next to", "near"), ("at the side of", "near"), ("in the vicinity of", "near"), ("in the neighbourhood of", "near"), ("not far from", "near"), ("closer to", "near"), ("nearer to", "near"), ("next to", "near"), ("close to", "near"), ("near to", "near"), ("near", "near"),
    ("nearby", "near"), ("beside", "near"), ("besides", "near"), ("by the side of", "near"), ("by", "near"),
    ("alongside", "near"), ("adjacent to", "near"), ("at", "near"), ("around", "near"), ("next", "near"),
    ("touching", "touching"), ("leaning on", "touching"), ("leaning against", "touching"), ("against", "touching"),
    ("on top of", "on"), ("onto", "on"), ("upon", "on"), ("standing on", "on"), ("lying on", "on"), ("sitting on", "on"),
    ("on", "on"), ("atop", "on"), ("above", "on"), ("over", "on"),
    ("underneath", "under"), ("buried under", "under"), ("under", "under"), ("beneath", "under"), ("below", "under"), ("supporting", "under"),
    ("in between", "between"), ("in among", "between"), ("between", "between"),
    ("from behind", "behind"), ("from under", "under"), ("from underneath", "under"), ("from beneath", "under"),
    ("from inside", "in"), ("from within", "in"), ("from next to", "near"), ("from beside", "near"), ("from between", "between"),
    ("from in front of", "in_front_of"), ("from on top of", "on"), ("from the top of", "on"), ("off of", "on"), ("off", "on"), ("out of", "in"), ("from", "on"),
    ("inside of", "in"), ("inside", "in"), ("into", "in"), ("in", "in"), ("within", "in"),
)  # fmt: skip
"""Phrase -> relation, the longer phrases first where one begins with another."""

BINS = (
    "bin", "the bin", "trash", "trash can", "trashcan", "rubbish", "rubbish bin", "garbage", "garbage can", "waste bin",
    "waste basket", "waste paper basket", "recycling bin", "recycling", "rubbish can", "rubbish basket", "litter bin", "garbage bin", "trash bin", "wastebasket", "basket", "dustbin", "dust bin", "waste", "tray",
)  # fmt: skip

CONTAINERS = (
    "bowl",
    "ceramic bowl",
    "cereal bowl",
    "soup bowl",
    "salad bowl",
    "box",
    "carton",
    "cardboard box",
    "package",
    "container",
)
"""Nouns into which a thing goes that is brought "to" them."""

MEASURES: dict[str, Measure] = {
    **dict.fromkeys(
        ("fragility", "fragile", "breakability", "delicacy", "delicate", "delicateness", "breakable", "sturdiness"),
        "fragility",
    ),
    **dict.fromkeys(("size", "sizes", "big", "large", "small", "height", "volume", "dimension", "tall"), "size"),
    **dict.fromkeys(("weight", "mass", "heavy", "heaviness", "light", "weights"), "weight"),
}
"""Word after "sort by" -> measure."""

PICK_VERBS = (
    "pick up", "pick", "grab", "grasp", "take", "lift up", "lift", "get", "fetch", "seize", "hold", "raise", "collect",
    "retrieve", "catch", "clutch", "grip", "snatch", "select", "acquire", "scoop up", "scoop", "hoist up", "hoist", "elevate",
    "pluck", "get hold of", "take hold of", "grab hold of", "lay hold of", "catch hold of", "reach for", "go for", "clasp",
    "nab", "snag", "secure", "procure", "obtain", "gather up", "gather", "take out", "get out", "lift out", "fish out",
    "dig out", "pick out", "choose", "recover", "extract", "take up", "raise up", "haul up", "haul", "grab up", "hold up",
    "go get", "go fetch", "go grab", "go take", "go pick up", "get your hand on", "get your hands on", "uplift", "heave",
)  # fmt: skip
HAND_VERBS = (
    "hand over",
    "hand",
    "give",
    "pass",
    "bring",
    "deliver",
    "offer",
    "serve",
    "present",
    "lend",
    "bring over",
    "pass over",
    "send over",
)
PLACE_VERBS = (
    "put down", "put", "place", "drop off", "drop", "set down", "set", "move", "lay down", "lay", "deposit", "throw", "toss",
    "chuck", "dump", "stash", "leave", "position", "stick", "shift", "transfer", "relocate", "release", "let go of", "stack",
    "carry", "slide", "rest", "stand", "park", "plop", "plonk", "pop", "stow", "tuck", "lower", "let down",
    "store", "drop in", "put back down", "rest down", "stick down",
)  # fmt: skip
DISCARD_VERBS = (
    "throw away", "throw out", "dispose of", "get rid of", "trash", "bin", "discard", "remove", "toss out", "clear away",
    "dump", "clear", "tidy away", "clean up", "put away", "tidy up", "ditch", "scrap", "junk", "chuck out", "chuck away",
    "toss away", "recycle", "do away with", "get shot of", "eliminate", "bin off", "take away",
)  # fmt: skip
"""Verbs that mean the bin by themselves."""
SORT_VERBS = ("sort", "arrange", "order", "line up", "rank", "organize", "organise")

UNABLE: dict[str, str] = {
    **dict.fromkeys(("pour", "pour out", "decant", "spill", "empty out", "refill"), "I cannot pour"),
    **dict.fromkeys(("fill",), "I cannot fill or pour"),
    **dict.fromkeys(
        ("open", "close", "unscrew", "screw", "uncork", "cut", "slice", "peel", "break", "smash", "crush", "squeeze",
         "cook", "wash", "wipe", "eat", "drink", "stir", "shake", "rotate", "turn", "flip", "push", "pull", "kick", "hit",
         "poke", "press", "roll", "spin", "write", "draw", "sing", "dance", "walk", "drive", "fly", "jump", "fold", "tie",
         "hammer", "drill", "paint", "juggle", "balance", "sweep", "vacuum", "type", "call", "charge", "bend", "twist", "tear",
         "rip", "crack", "burn", "heat", "boil", "mix", "blend", "wrap", "unwrap", "knock over", "knock", "tip over", "tip",
         "tickle", "lick", "taste", "smell", "scratch", "swing", "hug", "kiss", "punch", "stab", "bite", "attack", "destroy",
         "demolish", "ruin", "damage", "polish", "glue", "assemble", "build", "dismantle", "unpack", "plug", "unplug", "switch",
         "install", "repair", "fix", "bounce", "climb", "run", "swim", "crawl", "drag", "tap", "swap", "exchange", "duplicate",
         "melt", "inflate", "buy", "sell", "nudge", "shove", "bump", "topple", "slam", "fling", "hurl", "launch", "catapult",
         "weigh", "measure", "stretch", "chop", "bake", "fry", "stir up", "tilt", "lean", "hang", "hide", "bury", "explode"),
        "I cannot do that",
    ),
}  # fmt: skip
"""Verb -> the reason for refusing it."""
