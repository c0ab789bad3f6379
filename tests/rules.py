"""In which modes calls must be accepted, and in which refused.

Modes: Instantiated, Configuration (K), Initialization (N), Step, Event, Continuous-Time, clock Activation,
Terminated. For each call the modes in which the standard demands it and those in which it would do harm; else
either is right.
"""

RULES = {
    "enter_configuration": ("I", "KNSECAT"),
    "exit_configuration": ("K", "INSECAT"),
    "set_structure": ("K", "INSECAT"),
    "enter_initialization": ("I", "KNSECAT"),
    "exit_initialization": ("N", "IKSECAT"),
    "step": ("S", "IKNECAT"),
    "update": ("E", "IKNSCAT"),
    "enter_event": ("C", "IKNAT"),
    "enter_continuous": ("", "IKNSAT"),
    "enter_step": ("", "IKNCAT"),
    "activate": ("A", "IKNSECT"),
    "set_time": ("C", "KSAT"),
    "set_states": ("C", "IKNSAT"),
    "set_state": ("C", "IKNSEAT"),
    "get_states": ("NEC", "KSA"),
    "completed_step": ("C", "IKNSAT"),
    "get": ("NSECAT", ""),
    "set_input": ("INSEC", ""),
    "set_parameter": ("", "T"),
    "save": ("IKNSECT", "A"),
    "restore": ("IKNSECT", ""),
    "reset": ("IKNSECAT", ""),
    "terminate": ("SECA", "K"),
}
