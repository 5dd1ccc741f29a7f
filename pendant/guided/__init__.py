"""The free arm: whose force moves it, unintended motion, a lost payload, what ends it. Uses limits/, sensor/, walls/."""
