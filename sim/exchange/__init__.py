"""What passes between a tick and those outside: wishes in, pictures, scores and recorded rows out.

Uses arm/, compiled/, control/, flange/, gripping/, plant/, sensing/.
"""
