# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers that are expressions of others: 5*sqrt(a), 2^level/size."""
import ast
import math
import operator
import re

CONSTANTS = {"pi": math.pi}
FUNCTIONS = {name: getattr(math, name) for name in (
    "sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "floor",
    "ceil")}
FUNCTIONS |= {"abs": abs, "min": min, "max": max}
BINARY = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
          ast.Div: operator.truediv, ast.Pow: math.pow}
UNARY = {ast.UAdd: operator.pos, ast.USub: operator.neg}


class ExpressionError(ValueError):
    """What is wrong with an expression, for the user."""


def parse(text):
    """Parse a list of expressions set apart by commas into their trees; ^ is
    a power, and a function may stand as in Lua, math.sqrt."""
    text = re.sub(r"\bmath\.", "", text.strip()).replace("^", "**")
    try:
        tree = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        raise ExpressionError("it is no expression") from None
    return tree.elts if isinstance(tree, ast.Tuple) else [tree]


def names(tree):
    """Collect the names of a tree that are neither functions nor constants."""
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)
            and node.id not in FUNCTIONS and node.id not in CONSTANTS}


def _value(node, known):
    if (isinstance(node, ast.Constant)
            and type(node.value) in (int, float)):
        return float(node.value)
    if isinstance(node, ast.Name):
        if node.id in known:
            return known[node.id]
        if node.id in CONSTANTS:
            return CONSTANTS[node.id]
        raise ExpressionError(f"there is no number {node.id}; known: "
                              + ", ".join(sorted({*known, *CONSTANTS})))
    if isinstance(node, ast.BinOp) and type(node.op) in BINARY:
        return BINARY[type(node.op)](_value(node.left, known),
                                     _value(node.right, known))
    if isinstance(node, ast.UnaryOp) and type(node.op) in UNARY:
        return UNARY[type(node.op)](_value(node.operand, known))
    if (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
            and not node.keywords):
        if node.func.id not in FUNCTIONS:
            raise ExpressionError(f"there is no function {node.func.id}; "
                                  "known: " + ", ".join(sorted(FUNCTIONS)))
        return FUNCTIONS[node.func.id](*(_value(a, known) for a in node.args))
    raise ExpressionError("only numbers, names, + - * / ^, brackets and "
                          "functions are allowed")


def evaluate(tree, known):
    """Evaluate a tree with the numbers `known` {name: value}, which hide
    constants of the same name; nothing but arithmetic is ever done."""
    try:
        value = float(_value(tree, known))
    except ExpressionError:
        raise
    except (ArithmeticError, ValueError, TypeError, RecursionError) as error:
        raise ExpressionError(f"it has no value: {error}") from None
    if not math.isfinite(value):
        raise ExpressionError("it is not finite")
    return value
