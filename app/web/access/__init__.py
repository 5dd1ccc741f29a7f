"""Who gets in, who may act, and what their messages may say. Uses files/, web/widgets/."""
