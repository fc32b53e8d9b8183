"""Cleaning what was typed: case, punctuation, contractions, plurals and light typos. Text is data and never run."""

from __future__ import annotations

import re
import unicodedata
from functools import cache

from agent.language import courtesies, lexicon

CONTRACTIONS: tuple[tuple[str, str], ...] = (
    (r"\bwon't\b", "will not"), (r"\bcan't\b", "can not"), (r"\bcannot\b", "can not"), (r"n't\b", " not"),
    (r"\b(what|where|who|how|it|that|there|here|which)'s\b", r"\1 is"), (r"\blet's\b", "let us"), (r"'re\b", " are"),
    (r"'d\b", " would"), (r"'ll\b", " will"), (r"'ve\b", " have"), (r"\bi'm\b", "i am"), (r"'s\b", ""),
    (r"\bwhats\b", "what is"), (r"\bwheres\b", "where is"), (r"\bdont\b", "do not"), (r"\bdidnt\b", "did not"),
    (r"\bgimme\b", "give me"), (r"\bpickup\b", "pick up"), (r"\bwanna\b", "want to"), (r"\bgotta\b", "have to"),
    (r"\blemme\b", "let me"), (r"\bgonna\b", "going to"), (r"\bill\b", "i will"), (r"\bur\b", "your"), (r"\bu\b", "you"), (r"\bya\b", "you"), (r"\bw+h*o+a+h*\b", "whoa"),
    (r"\b(teh|hte|th)\b", "the"), (r"\band than\b", "and then"),
    (r"\bs+t+o+p+\b", "stop"), (r"\b(?:stahp|stpo|sotp|satop|tsop)\b", "stop"), (r"\s&\s", " and "),
    (r"\b(?:wher|whre|wheer|whear)\b", "where"), (r"\b(?:waht|wat|whta|hwat|wht)\b", "what"), (r"\b(?:wats|wahts|whast)\b", "what is"), (r"\bwich\b", "which"), (r"\b(?:nxt|nex) to\b", "next to"),
    (r"\b(?:wen|whn)\b", "when"), (r"\b(?:whi|wy|hwy)\b", "why"), (r"\b(?:adn|nad|annd)\b", "and"), (r"\bthx\b", "thanks"), (r"\b(?:plz|pls|plse|pleas|pleae)\b", "please"),
    (r"\bkinda\b", "kind of"), (r"\bcoulda\b", "could have"), (r"\bwudja\b", "would you"), (r"\bcud\b", "could"), (r"\bem\b", "them"), (r"\by'all\b", "you"), (r"\bim\b", "i am"), (r"\bid like\b", "i would like"),
    (r"\bive\b", "i have"), (r"\bcant\b", "can not"), (r"\bwont\b", "will not"), (r"\b(?:puck|pock|oick|pikc|pic|pck|picl) up\b", "pick up"), (r"\b(?:teh|hte) ", "the "), (r"\btht\b", "that"), (r"\bfrm\b", "from"), (r"\bonot\b", "onto"), (r"\bwiht\b", "with"), (r"\bdnt\b", "do not"),
    (r"\b(?:taht|tath)\b", "that"), (r"\b(?:yuo|yu)\b", "you"), (r"\bint he\b", "in the"), (r"\bont he\b", "on the"), (r"\b(?:lft|letf)\b", "left"), (r"\b(?:rigth|rite|rihgt|rght)\b", "right"),
    (r"\bwere (is|are)\b", r"where \1"), (r"\bpik\b", "pick"), (r"\bsee through\b", "see-through"),
)  # fmt: skip

IRREGULAR = {
    "glasses": "glass", "boxes": "box", "vases": "vase", "dishes": "dish", "knives": "knife", "dice": "dice",
    "scissors": "scissors", "pliers": "pliers", "electronics": "electronics", "glass": "glass", "bus": "bus",
    "matches": "match", "brushes": "brush", "tomatoes": "tomato", "potatoes": "potato", "others": "other",
    "this": "this", "is": "is", "its": "its", "was": "was", "does": "does", "has": "has", "us": "us", "less": "less",
    "canvas": "canvas", "wireless": "wireless", "yes": "yes", "always": "always", "towards": "towards", "as": "as",
    "sturdiness": "sturdiness", "heaviness": "heaviness", "delicateness": "delicateness", "newtons": "newtons",
}  # fmt: skip

COMMON = (
    "the a an this that these those it its them they there here all any some every each both other another everything "
    "something anything nothing none and or but not no without except than then first with of to from for at by on in into "
    "onto up down off over under near next close beside behind between front back left right middle centre center side top "
    "bottom edge corner table desk floor counter bench surface is are was were be been do did does done have has had will "
    "would could can should may might must shall what where which who whom why how when whose if because so as like me my "
    "mine you your yours i we our us he she his her him please thanks thank hello hi yes no okay not never only also too "
    "very more most less least much many few one two three four five six seven eight nine ten hand hands arm arms gripper "
    "robot way such see look show tell say said find locate list describe count name explain mean happen happened happens "
    "wrong work worked fail failed drop dropped slip slipped force newton newtons kg kilogram kilograms gram grams holding "
    "used use using tried try instead before after again same different home wait stop halt freeze abort cancel undo revert "
    "return help pour fill water juice wine coffee tea milk fragile most order sort weight size height color colour colored "
    "coloured made out still know think want need like going go come make let away rid clear clean tidy whole entire things "
    "round square long short tall wide thin thick flat full filled empty broken new old nice lovely shiny dirty clean dark "
    "bright pale standing lying sitting placed located visible there's else plus both single pair half quarter ascending "
    "descending increasing decreasing lane lanes row line sturdy strong weak soft hard sharp warm cold hot top upside case "
    "wall band bold tape vast rare care mile bone bowed plane place places wine bow book boot cake cap cop pan pot plan fast "
    "love life word world work time light right night house horse mouse head foot feet face voice note wind want wish poem "
    "story joke song weather today tomorrow yesterday capital france president number question answer python code run file "
    "ignore previous instructions system prompt delete print exec import shell root password reveal pretend meaning god "
    "went gone came come goes gave given took taken held kept fell broke felt knew made makes told said asked wanted liked "
    "tried used looked worked seemed maybe perhaps really quite rather somehow actually sorry mean meant reasoning strategy "
    "enough newton plus minus times already still ever just being having doing getting going anyone everyone someone "
    "safe nice suitable shape shapes material kind type category state location shelf shelves kitchen fridge garden sofa cupboard drawer cabinet sink oven rack stove bookshelf couch "
    "simulate quit cease movement movements motion stay still remain suspend interrupt terminate power shut mess stem handle rim neck body "
    "shaft lip brim grip grasp lost where there number overview position gone tell reason cause behind choice decision thinking "
    "step steps task job mission grab enough topmost upper lower others lot lots bunch couple several rotten dirty chance possible "
    "pinch power grasp grip rim lip brim stem neck handle body belly gentle gentler gently softer lighter firmer tighter looser "
    "slower faster quicker yaw aperture opening wider candidate attempt attempts compare report summary forget remember "
    "while whilst during until though although upright level straight steady keeping touch avoid protect mind leave keep spill break careful nothing nobody nowhere anywhere somewhere somebody"
).split()
"""Ordinary English words that are never taken for typos of something else."""


def clean(text: str) -> str:
    """Lower case, plain quotes and spaces, contractions written out; separators kept as " , " " . " and " ; "."""
    plain = unicodedata.normalize("NFKC", text).replace("\u2019", "'").replace("\u2018", "'").lower()
    plain = "".join(c for c in plain if unicodedata.category(c) not in ("Cf", "Cc") or c in "\n\t ")
    for pattern, becomes in CONTRACTIONS:
        plain = re.sub(pattern, becomes, plain)
    plain = re.sub(r"(\d)[,.](\d)", r"\1#\2", plain)
    plain = re.sub(r"[!?:\n]+|\.{1,}", " . ", plain)
    plain = re.sub(r"([,;])", r" \1 ", plain)
    plain = re.sub(r"(?<!see)-|[\"'`*_()\[\]{}<>/\\|~^=+&%$@]", " ", plain)
    plain = re.sub(r"(\d)\s*(kg|n|g)\b", r"\1 \2", plain.replace("#", "."))
    plain = re.sub(r"(?<!\d)\.(?!\d)", " . ", plain)
    return " ".join(plain.split())


def words(text: str) -> list[str]:
    """Cleaned tokens with plurals kept, and light typos of known words mended."""
    return [mend(token) for token in clean(text).split()]


def singular(word: str) -> str:
    """The singular of a noun, as far as our nouns need it."""
    if word in IRREGULAR:
        return IRREGULAR[word]
    if len(word) > 3 and word.endswith("ies"):
        return word[:-3] + "y"
    if len(word) > 3 and word.endswith("s") and not word.endswith("ss"):
        return word[:-1]
    return word


@cache
def vocabulary() -> frozenset[str]:
    """Every single word that the parser knows."""
    phrases = [
        *lexicon.NOUNS, *lexicon.GENERIC, *lexicon.UNSEEN_NOUNS, *lexicon.COLOURS, *lexicon.MATERIALS,
        *lexicon.QUALITIES, *lexicon.EXTREMES, *lexicon.ORDINALS, *lexicon.NUMBERS, *lexicon.SIDES, *lexicon.BINS,
        *lexicon.MEASURES, *lexicon.PICK_VERBS, *lexicon.HAND_VERBS, *lexicon.PLACE_VERBS, *lexicon.DISCARD_VERBS,
        *lexicon.SORT_VERBS, *lexicon.UNABLE, *courtesies.FILLERS, *courtesies.OPENERS, *(p for p, _ in lexicon.RELATIONS),
    ]  # fmt: skip
    return frozenset(word for phrase in phrases for word in phrase.split()) | frozenset(COMMON)


@cache
def mend(token: str) -> str:
    """The known word that `token` is a light typo of, or `token` itself.

    Only words of four letters or more that begin alike (or swap two neighbours) are mended, by one edit, from eight
    letters by two; where two known words are equally near, nothing is guessed.
    """
    if len(token) == 3 and token not in vocabulary():
        swapped = {token[1] + token[0] + token[2], token[0] + token[2] + token[1]} & set(lexicon.NOUNS)
        longer = {w for w in _CONTENT | _SHORT if len(w) == 4 and w[0] == token[0] and edits(token, w, 1) == 1}
        likely = swapped or (longer if token not in THREE else set())
        return likely.pop() if len(likely) == 1 else token
    if not token.isalpha() or len(token) < 4 or token in vocabulary() or singular(token) in vocabulary():
        return token
    limit = 2 if len(token) >= 8 else 1
    best: dict[int, dict[str, str]] = {}
    for word in vocabulary():
        if abs(len(word) - len(token)) > limit + 1 or len(word) < 3:
            continue
        if word[0] != token[0] and word[:2] != token[1::-1]:
            continue
        for form in (word, word + "s") if word in _CONTENT else (word,):
            distance = edits(token, form, limit)
            if distance <= limit:
                best.setdefault(distance, {}).setdefault(word, form)
    if not best:
        return token
    nearest = best[min(best)]
    if len(nearest) > 1:
        nearest = {word: form for word, form in nearest.items() if word in _CONTENT} or nearest
    if len(nearest) > 1:  # two letters swapped is the likelier slip
        nearest = {word: form for word, form in nearest.items() if sorted(form) == sorted(token)} or nearest
    return next(iter(nearest.values())) if len(nearest) == 1 else token


_CONTENT = frozenset(
    word for phrase in (*lexicon.NOUNS, *lexicon.PICK_VERBS, *lexicon.COLOURS) for word in phrase.split()
)
"""Words that win a tie between two mendings: things, colours and taking."""


_SHORT = frozenset(("give", "hand", "pass", "next", "left", "sort", "near", "move", "with", "from", "what", "this"))
THREE = frozenset(
    "pet bat rat mat sat fat oil ice gas pie pig cow hen fox bee ant leg ear eye lip toe kid boy man men dad mum son sun sky sea air "
    "van bed tub mud fog zip gum jam ham nut fig rye ivy elm oak fir log pin rod wig net ink dye art fun war law tax fee ale gin rum "
    "nap rug bib big bit bad bag ban bar bet bid bob bog bud bug bun buy cab cob cod cot cry cue dam day den dew did dig dim dip dog "
    "dot dry due dug end eve fan far fed few fin fit fix fly foe for fry fur gap gem get god got gun gut guy had has hay her hid him "
    "hip his hit hob hog hop hot how hub hug hum hut ill jar jaw jet job jog joy jug key lab lad lap lay led let lid lie lit lot low "
    "mad map mix mob mop mow nod nor now odd off old one our out owe own pad pay pea pep pit pod pop pub put ran rap raw ray red rib "
    "rid rip rob rot row rub run sad saw say set sew she shy sin sip sir sit six ski sob sow soy spa spy tab tag tan tap tar tie tin "
    "tip ton top tow try tug two use vet via vow wax way web wed wet who why win wit won yes yet you zoo ran gel pal cad lag".split()
)
"""English words of three letters that are no typos of something longer."""


def edits(a: str, b: str, limit: int) -> int:
    """Optimal string alignment distance (insert, delete, replace, swap neighbours), cut off above `limit`."""
    previous: list[int] = []
    row = list(range(len(b) + 1))
    for i, x in enumerate(a, 1):
        before, previous, row = previous, row, [i]
        for j, y in enumerate(b, 1):
            cost = min(previous[j] + 1, row[j - 1] + 1, previous[j - 1] + (x != y))
            if i > 1 and j > 1 and x == b[j - 2] and a[i - 2] == y:
                cost = min(cost, before[j - 2] + 1)
            row.append(cost)
        if min(row) > limit:
            return limit + 1
    return row[-1]
