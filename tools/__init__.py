"""What an agent can do: one verb per file, each a typed function that works alone.

`from tools import execute_grasp` gives the function; its argument model is in the file of the same name.
"""

from tools.build_scene_graph import build_scene_graph
from tools.classify_failure import classify_failure
from tools.correct_grasp import correct_grasp
from tools.execute_grasp import execute_grasp
from tools.gather_experience import gather_experience
from tools.infer_constraints import infer_constraints
from tools.perceive import perceive
from tools.place_object import place_object
from tools.plan_grasp import plan_grasp
from tools.retrieve_haarag import retrieve_haarag

__all__ = [
    "build_scene_graph",
    "classify_failure",
    "correct_grasp",
    "execute_grasp",
    "gather_experience",
    "infer_constraints",
    "perceive",
    "place_object",
    "plan_grasp",
    "retrieve_haarag",
]
