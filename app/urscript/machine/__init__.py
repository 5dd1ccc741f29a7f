"""From a tree to steps that a tick can stop at: values, operators, compiler, threads.

Uses urscript/language/.
"""
