"""Politeness: words and beginnings of a command that change nothing of what is asked. Data only."""

from __future__ import annotations

FILLERS = (
    "please", "kindly", "just", "now", "robot", "panda", "hey", "hi", "hello", "ok", "okay", "well", "so", "um", "uh", "oh",
    "gently", "carefully", "slowly", "quickly", "softly", "immediately", "again", "maybe", "simply", "thanks", "thank you",
    "cheers", "alright", "then", "also", "too", "right now", "for me", "if you can", "if possible", "if you do not mind",
    "after that", "after this", "thank you very much", "thank you so much",
    "thanks a lot", "many thanks", "thanks very much", "as soon as possible", "very carefully", "really", "finally", "next", "pls", "plz", "buddy",
    "my friend", "dear", "there", "quick", "try to", "go ahead and", "i said", "with your gripper", "with the gripper",
    "with care", "sir", "mate", "pal", "man", "dude", "bro", "folks", "ta", "thx", "asap", "for a bit", "for now", "if you would", "if you will",
    "if that is ok", "if that is okay", "if it is not too much trouble", "when you can", "when you have time", "when you are ready", "straight away", "right away", "at last",
    "with caution", "delicately", "cautiously", "nicely", "tenderly", "in a moment", "once more", "one more time", "any time", "anytime", "good robot", "my dear", "love", "yeah", "yes", "yep", "sure", "great", "good", "fine", "perfect", "excellent", "cool", "alrighty", "anyway", "actually", "basically", "hmm", "hm", "ah", "er", "erm", "uhm", "good morning", "good evening", "good afternoon", "greetings", "howdy", "yo", "excuse me", "sorry", "hello there", "hey there", "hi there", "ok robot", "dear robot", "afterwards", "for us", "over there", "right there",
)  # fmt: skip
"""Words and phrases that change nothing; taken away at the ends of a clause."""

TAGS = ("would you", "will you", "could you", "can you", "would you mind", "right", "okay")
"""Fillers at the end of a command only: at its beginning they open a request."""

OPENERS = (
    "would you be so kind as to", "be so kind as to", "would you be so kind and", "would you mind", "do you mind", "can i ask you to",
    "could you please", "can you please", "would you please", "could you", "can you", "would you kindly",
    "would you", "will you", "i want you to", "i would like you to", "i need you to", "i want to see you", "you should",
    "you can", "you may", "you must", "let us", "let me see you", "try to", "please try to", "go and", "go ahead and",
    "i wish you would", "i am asking you to", "your task is to", "your job is to", "the task is to", "make sure to",
    "do me a favour and", "do me a favor and", "are you able to", "is it possible to", "how about you", "why do not you",
    "start by", "begin by", "start off by", "start off with", "start with", "begin with", "i would appreciate it if you could", "help me", "i was wondering if you could", "i was wondering whether you could",
    "i wonder if you could", "i wonder whether you could", "would it be possible to", "would it be possible for you to",
    "would it be ok to", "would it be okay to", "might you", "could i ask you to", "may i ask you to", "can i get you to",
    "could i get you to", "be a dear and", "be a darling and", "be an angel and", "be a good robot and", "be so good as to",
    "be nice and", "any chance you could", "any chance of", "is there any chance you could", "any chance that you could",
    "see if you can", "see if you could", "see whether you can", "make sure you", "make sure that you", "be sure to",
    "be sure you", "do not forget to", "remember to", "try and", "please try and", "attempt to", "reach over and", "reach out and",
    "lean over and", "come over and", "come and", "go over and", "go there and", "you may now", "you can now", "you could",
    "you might", "you need to", "you have to", "you are to", "you will", "you shall", "i would love you to", "i would love it if you could",
    "i would like to see you", "i would love to see you", "i would like it if you", "i would love for you to", "i would be grateful if you", "i would be glad if you", "i would be happy if you", "it would be great if you",
    "it would be nice if you", "i would appreciate it if you", "i would love it if you", "i would be grateful if you could", "i would be glad if you could",
    "i would be happy if you could", "it would be great if you could", "it would be nice if you could", "it would be good if you could",
    "it would help if you could", "i want to have you", "i would have you", "i want you now to", "i expect you to", "i order you to",
    "i command you to", "i ask you to", "i beg you to", "i hope you can", "i hope you could", "i think you should", "why not",
    "how about", "what about", "what if you", "if you could", "if you would", "if you can", "if you please", "if possible",
    "if you do not mind", "if it is possible", "do you think you could", "do you think you can", "think you could", "think you can", "are you capable of",
    "feel free to", "proceed to", "continue by", "continue with", "get ready to", "time to", "it is time to", "we need to", "we have to",
    "we should", "we want to", "i need to", "i want to", "i would like to", "i have to", "please do", "do me a favour", "do me a favor",
    "use your gripper to", "use the gripper to", "use your hand to", "use your arm to", "with your hand", "with your arm", "with your gripper",
    "your next task is to", "next task is to", "then please", "i would rather you", "i prefer that you", "i would prefer you to", "i would prefer if you",
)  # fmt: skip
"""Polite or roundabout beginnings of a command."""
