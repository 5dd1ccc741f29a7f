"""How the pendant looks: one style sheet on top of viser's controls."""

from collections.abc import Iterable

QUIET = "background:rgba(134,142,150,.12);color:inherit;border:1px solid rgba(134,142,150,.28)"
"""How a button looks that needs no eye."""


def sheet(stop: str, free_drive: str, quiet: Iterable[str]) -> str:
    """The style sheet of the page; the arguments are the ids of its controls, `quiet` those of the buttons that need no eye.

    The part of the right column that has the stop but not the free-drive button gets the height it needs and keeps it (viser
    gives stacked panels equal shares), and the column cannot be folded away: the emergency stop is always in sight.
    """
    main, low = f':has([id="{free_drive}"])', f':has([id="{stop}"])'
    plain = ",".join(f'[id="{button}"]' for button in quiet)
    return f"""<style>
{main}>{low}:not({main}){{flex:0 0 170px!important}} {low}>{main}:not({low}){{flex:1 1 0!important}}
[style*="right: 0px"]{low} [aria-label="Collapse panel area"]{{display:none!important}}
.pd-light{{display:flex;align-items:center;gap:12px;margin:2px 12px 10px;padding:12px 14px;border-radius:8px;
  background:color-mix(in srgb,var(--c) 9%,transparent);border:1px solid color-mix(in srgb,var(--c) 35%,transparent)}}
.pd-light i{{width:18px;height:18px;border-radius:50%;background:var(--c);
  box-shadow:0 0 0 4px color-mix(in srgb,var(--c) 22%,transparent)}}
.pd-light div{{flex:1;line-height:1.15}}
.pd-light b{{display:block;font-size:17px;letter-spacing:.02em}}
.pd-light span{{font-size:12.5px;color:var(--c);font-weight:600}}
.pd-light em{{font-style:normal;font-size:10.5px;text-align:right;opacity:.75;text-transform:uppercase;letter-spacing:.06em}}
.pd-light strong{{display:block;font-size:12px;letter-spacing:0}}
[role=tab]{{padding-left:8px!important;padding-right:8px!important}}
.pd-rings{{display:flex;gap:10px;justify-content:center;align-items:center;min-height:86px;margin:0 12px 6px}}
.pd-rings figure{{margin:0;text-align:center}} .pd-rings svg{{display:block;margin:0 auto}}
.pd-rings figcaption{{font-size:11.5px;margin-top:3px;opacity:.8}}
.pd-rings p{{margin:0;font-size:12px;opacity:.5}}
.pd-who{{display:flex;align-items:center;gap:8px;height:30px;margin:0 12px 6px;font-size:12.5px}}
.pd-who i{{width:8px;height:8px;border-radius:50%;background:var(--c)}} .pd-who b{{font-weight:600}}
.pd-note{{margin:2px 12px 10px;padding:8px 12px;border-left:3px solid var(--c);border-radius:0 6px 6px 0;
  background:color-mix(in srgb,var(--c) 7%,transparent);font-size:12.5px;line-height:1.4}}
.pd-note b{{display:block}} .pd-note span{{opacity:.8}}
.pd-note ul{{margin:5px 0 0;padding:0;list-style:none;font-size:11.5px;font-variant-numeric:tabular-nums;opacity:.8}}
.pd-bars{{margin:4px 14px 8px;font-size:11.5px;line-height:1.3}}
.pd-bars div{{display:grid;grid-template-columns:1fr auto;gap:1px 8px;margin-bottom:4px}}
.pd-bars em{{font-style:normal;font-variant-numeric:tabular-nums}}
.pd-bars i{{grid-column:1/3;height:4px;border-radius:2px;
  background:linear-gradient(90deg,var(--c) var(--s),rgba(134,142,150,.2) 0)}}
.pd-bars p{{margin:2px 0 0;opacity:.55}}
.pd-facts{{display:grid;grid-template-columns:1fr auto;gap:3px 12px;margin:4px 14px 10px;font-size:12.5px}}
.pd-facts dt{{opacity:.65}} .pd-facts dd{{margin:0;text-align:right;font-variant-numeric:tabular-nums;font-weight:500}}
.pd-log{{padding:4px 4px 8px;font-size:12.5px}}
.pd-log table{{border-collapse:collapse;width:100%}}
.pd-log td{{padding:5px 6px;vertical-align:top;border-bottom:1px solid rgba(128,128,128,.14);line-height:1.35}}
.pd-log td:nth-child(1){{width:8px;padding-right:0}}
.pd-log td:nth-child(2){{font-variant-numeric:tabular-nums;opacity:.6;white-space:nowrap;width:1%}}
.pd-log i{{display:block;width:7px;height:7px;border-radius:50%;background:var(--c);margin-top:5px}}
.pd-loads{{display:grid;grid-template-columns:1fr 1fr;gap:4px 8px;margin:2px 12px 8px;font-size:11.5px}}
.pd-loads span{{padding:5px 8px;border-radius:6px;background:rgba(134,142,150,.12)}}
.pd-loads b{{display:block;font-size:15px}}
.pd-loads em{{grid-column:1/3;font-style:normal;font-weight:600;color:var(--c)}}
.pd-chart{{margin:4px 12px 10px;font-size:11px}} .pd-chart figcaption{{display:flex;justify-content:space-between}}
.pd-chart em{{font-style:normal;opacity:.6;font-variant-numeric:tabular-nums}}
.pd-chart svg{{display:block;width:100%;height:84px;margin:2px 0;background:rgba(134,142,150,.08);border-radius:4px}}
.pd-chart div{{display:flex;flex-wrap:wrap;gap:2px 10px}} .pd-chart span{{display:flex;align-items:center;gap:4px}}
.pd-chart i{{width:12px;border-top:2px solid var(--c)}} .pd-chart .pd-dash i{{border-top-style:dashed}}
.pd-contacts{{padding:2px 8px 8px;font-size:11.5px}} .pd-contacts table{{border-collapse:collapse;width:100%}}
.pd-contacts th{{text-align:left;font-weight:500;opacity:.55}}
.pd-contacts td,.pd-contacts th{{padding:3px;border-bottom:1px solid rgba(128,128,128,.14)}}
.pd-contacts td{{font-variant-numeric:tabular-nums}}
.pd-steps{{margin:2px 12px 8px;padding-left:22px;font-size:12px;line-height:1.5;max-height:130px;overflow:auto}}
.pd-steps .pd-now{{font-weight:700}} .pd-steps em{{font-style:normal;color:#1971c2}}
.pd-fine{{margin:-2px 12px 8px;font-size:11px;line-height:1.3;opacity:.6}}
[data-mantine-color-scheme="dark"] :is(.pd-light span,.pd-loads em,.pd-steps em){{
  color:color-mix(in srgb,var(--c,#1971c2) 55%,#fff)}}
div:has(>.mantine-NumberInput-root:nth-child(3)) .mantine-NumberInput-section{{display:none}}
div:has(>.mantine-NumberInput-root:nth-child(3)) input{{padding:0 5px!important}}
.mantine-Notification-root[style*="orange"] .mantine-Notification-description{{display:none}}
.pd-empty{{padding:10px 12px;margin:0;font-size:12.5px;opacity:.55}}
[id="{free_drive}"]{{height:56px!important;font-size:16px;border-radius:8px;user-select:none;touch-action:none}}
.mantine-Button-section{{margin-inline-end:8px!important}}
[id="{stop}"]{{height:64px!important;font-size:17px;font-weight:700;letter-spacing:.05em;border-radius:8px}}
{plain}{{{QUIET};height:34px!important;border-radius:8px}} {plain.replace("]", "]:disabled")}{{opacity:.45}}
</style>"""


def beside(button: str) -> str:
    """Put the button with this id at the end of the line above it."""
    return (
        f'<style>div:has(>[id="{button}"]){{margin:-36px 12px 6px auto!important;padding:0!important;width:76px}}'
        f'[id="{button}"]{{height:28px!important;font-size:12px;padding:0;border-radius:6px;{QUIET}}}</style>'
    )
