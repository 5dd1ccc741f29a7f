"""Functions of the language that only calculate: numbers, lists, poses, texts, frames.

Uses urscript/language/, urscript/machine/.
"""
