"""What leaves a script for other machines, and which of them it may call: sockets, XML-RPC, Modbus.

Uses urscript/language/, urscript/machine/.
"""
