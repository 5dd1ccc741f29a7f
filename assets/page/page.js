// What the page needs beyond viser's controls: a picture until they are there, what is told when the connection is lost, names
// for screen readers, the keyboard, and what a reload must not forget. It sends nothing of its own: it presses viser's controls.
(() => {
  const KEPT = "pendant-page", STALE = 3000, BEAT = 500, OPENING = 20000, NARROW = 300, ANSWER = 4000;
  const at = (selector, within = document) => within.querySelector(selector);
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const read = () => { try { return JSON.parse(localStorage.getItem(KEPT)) || {}; } catch { return {}; } };
  const kept = read();
  const keep = (name, value) => { kept[name] = value; try { localStorage.setItem(KEPT, JSON.stringify(kept)); } catch { /* not kept */ } };
  const made = (tag, id, role) => Object.assign(document.createElement(tag), { id, role });
  const began = performance.now();
  if (kept.dark === undefined) kept.dark = matchMedia("(prefers-color-scheme: dark)").matches; // until somebody chooses
  if (kept.dark) document.documentElement.classList.add("pd-night");

  // The free-drive button and the stop: their ids stand on the style sheet that the server sends.
  const named = (name) => { const sheet = at(`style[data-pd-${name}]`); return sheet && document.getElementById(sheet.getAttribute(`data-pd-${name}`)); };
  const freeDrive = () => named("free-drive"), stop = () => named("stop");

  // A press of a button that is held ends with a click, wherever the pointer is lifted, also when the press became a scroll: the
  // server counts a hold that fell silent as ended until it has heard of the click.
  const STILL = 150;
  let pressed = null;
  const held = (button) => button === freeDrive() || at(`style[data-pd-held~="${button.id}"]`);
  const lift = (event) => { if (!pressed || event.pointerId !== pressed.pointer) return;
    const { button } = pressed; pressed = null;
    let clicked = false; const heard = () => { clicked = true; };
    button.addEventListener("click", heard, { once: true });
    setTimeout(() => { button.removeEventListener("click", heard); if (!clicked) button.click(); }, 80); };
  addEventListener("pointerdown", (event) => { const button = event.target.closest && event.target.closest("button[id]");
    if (button && event.button === 0 && (!pressed || event.isPrimary) && held(button)) pressed = { button, pointer: event.pointerId, since: performance.now() }; }, true);
  for (const name of ["pointerup", "pointercancel"]) addEventListener(name, lift, true);
  // A finger that has been still on such a button holds it, and scrolls no more.
  addEventListener("touchmove", (event) => { if (pressed && event.cancelable && performance.now() - pressed.since > STILL) event.preventDefault(); },
    { capture: true, passive: false });
  // Whatever lies over the stop, as the palette of commands or a list that is open: a press on its place stops.
  addEventListener("pointerdown", ({ clientX: x, clientY: y, target }) => { const button = stop(); if (!button || button.contains(target)) return;
    const { left, right, top, bottom } = button.getBoundingClientRect();
    if (left < x && x < right && top < y && y < bottom) button.click(); }, true);
  // A finger that holds a button asks for no menu.
  addEventListener("contextmenu", (event) => { if (event.target.closest && event.target.closest("button,canvas")) event.preventDefault(); });

  // Space and Enter hold the free-drive button as a finger does; leaving the page lets go.
  let key = null;
  const pointer = (type) => new PointerEvent(type, { bubbles: true, button: 0, buttons: type === "pointerdown" ? 1 : 0, pointerId: 1, isPrimary: true });
  const release = () => { if (!key) return; key = null; const button = freeDrive(); if (button) { button.dispatchEvent(pointer("pointerup")); } };
  addEventListener("keydown", (event) => { const button = freeDrive();
    if (!button || document.activeElement !== button || (event.key !== " " && event.key !== "Enter")) return;
    event.preventDefault();
    if (!key && !button.disabled) { key = event.key; button.dispatchEvent(pointer("pointerdown")); } }, true);
  addEventListener("keyup", (event) => { if (event.key === key) { event.preventDefault(); release(); } }, true);
  addEventListener("blur", release); document.addEventListener("visibilitychange", release); addEventListener("focusout", release);

  // The connection: the server's beat changes again and again while it is there.
  //
  // A browser makes a page wait for its next WebSocket, longer with each one that failed. viser asks for a new one each second, which
  // ends the one that waits: after about 40 of them none comes through any more. So the page asks by HTTP whether the server is there,
  // for ever and at most each LONGEST_PAUSE, and lets viser connect when it is. A page that nobody looks at asks as well.
  const LONGEST_PAUSE = 5000, CONNECTING = 6000, DEAD = 30000, ENTRY = "/entry";
  let worker = null, asking = false, asked = 0, pause = 0, connect = 0, barred = false;
  const post = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function (message, ...rest) {
    if (message && message.type === "set_server") worker = this;
    if (message && message.type === "retry") { askForEntry(); return; }
    post.call(this, message, ...rest); };
  document.hasFocus = () => true;
  const askForEntry = () => { const now = performance.now();
    if (asking || !worker || now - asked < pause || now - connect < CONNECTING) return;
    asking = true; asked = now;
    const limit = new AbortController(); setTimeout(() => limit.abort(), LONGEST_PAUSE);
    fetch(ENTRY, { cache: "no-store", signal: limit.signal }).then((answer) => { barred = answer.status === 401 || answer.status === 403;
      if (!answer.ok) throw new Error(answer.statusText);
      pause = 0; connect = performance.now(); post.call(worker, { type: "retry" }); })
      .catch(() => { pause = Math.min(pause * 1.5 + 500, LONGEST_PAUSE); }).finally(() => { asking = false; }); };

  let beat = "", heard = performance.now(), presses = 0, back = 0;
  const SAID = 10000;
  addEventListener("pointerdown", (event) => { if (document.documentElement.classList.contains("pd-cut") && event.target.closest && event.target.closest("button,input,[role=radio],[role=slider]") && !event.target.closest("#pd-lost")) presses += 1; }, true);
  const lasted = (seconds) => seconds < 120 ? `${seconds} s` : `${Math.floor(seconds / 60)} minutes`;
  const banner = (text, reload) => { const lost = at("#pd-lost"), [words, button] = lost.children;
    if (words.textContent !== text) words.textContent = text; button.hidden = !reload; };
  const listen = () => { const now = at("[data-pd-beat]"), value = now ? now.getAttribute("data-pd-beat") : "";
    if (value && value !== beat) { beat = value; heard = performance.now(); }
    const lost = at("#pd-lost"), silent = performance.now() - heard, cut = Boolean(beat) && silent > STALE;
    if (cut && silent > DEAD) askForEntry(); // of a connection that is dead the browser may not know
    if (lost && document.visibilityState === "visible") {
      const gone = `No answer from the simulation for ${lasted(Math.floor(silent / 1000))}. What you see is old; nothing that you press arrives.`;
      const told = cut ? `${gone} ${barred ? "It does not let this page in: open the link that pendant has printed." : "Trying again, until it answers."}` : "";
      const root = document.documentElement, picture = at(".pd-picture");
      if (cut !== root.classList.contains("pd-cut")) { root.classList.toggle("pd-cut", cut);
        if (cut) { presses = back = 0; restored = false; release(); } else { if (presses) back = performance.now(); restore(); } }
      const again = back && performance.now() - back < SAID;
      if (told || again) { const box = (picture || document.body).getBoundingClientRect();
        Object.assign(lost.style, { left: `${box.left}px`, width: `${box.width}px`, top: `${Math.max(box.top, 0)}px` });
        banner(told || `The simulation answers again. What you pressed meanwhile (${presses}) may not have arrived: look, and press again.`, cut); }
      lost.classList.toggle("pd-on", Boolean(told || again)); lost.classList.toggle("pd-back", !told && Boolean(again)); }
    if (beat && at(".pd-picture") && at("#pd-opening") || performance.now() - began > OPENING) open(); };
  const open = () => { const shown = at("#pd-opening"); if (!shown) return; shown.classList.add("pd-gone"); setTimeout(() => shown.remove(), 300); restore();
    const place = at(".pd-picture"); if (place && stop() && !at("#pd-tour")) { const card = made("section", "pd-tour", "region"); card.setAttribute("aria-label", "Tour"); place.append(card); tour(); } };

  // What a reload keeps: dark or light, the tabs that were chosen, the width of the left side.
  const strips = () => all("[role=tablist]").filter((list) => list.getBoundingClientRect().left < innerWidth / 2);
  let restored = false, darkens = 0;
  const isDark = () => document.documentElement.dataset.mantineColorScheme === "dark";
  // The key counts only once the simulation knows this client: it is pressed again until the page was dark.
  const darken = () => { if (isDark() || !darkens) { darkens = 0; return; }
    darkens -= 1;
    document.documentElement.dispatchEvent(new KeyboardEvent("keydown", { key: "t", code: "KeyT", bubbles: true }));
    setTimeout(darken, ANSWER); };
  const restore = () => { if (restored) return; restored = true;
    if (kept.dark) { darkens = 6; darken(); }
    for (const list of strips()) for (const tab of all("[role=tab]", list))
      if ((kept.tabs || []).includes(tab.textContent.trim()) && tab.getAttribute("aria-selected") !== "true") press(tab);
    if (innerWidth > 1000 && (kept.width || innerWidth < 1200)) resize(kept.width || NARROW); };
  // Editing in 3D is over when its tab is left.
  for (const name of ["pointerdown", "click"]) addEventListener(name, (event) => { // a tab is open before its click, which keys make alone
    const tab = event.isTrusted && event.target.closest && event.target.closest("[role=tab]"); if (!tab || tab.getAttribute("aria-selected") === "true") return;
    let box = tab.closest("[role=tablist]").parentElement; while (box && !at("button,input", box)) box = box.parentElement;
    for (const edits of box ? all("input[type=checkbox]:checked", box) : []) if (labelled(edits) === "Edit in 3D") edits.click(); }, true);
  // A tab opens at its top.
  addEventListener("click", (event) => { const tab = event.target.closest && event.target.closest("[role=tab]"); if (!tab) return;
    let box = tab.closest("[role=tablist]").parentElement; while (box && !at("button,input", box)) box = box.parentElement;
    setTimeout(() => { for (const inside of box ? all("*", box) : []) if (inside.scrollTop) inside.scrollTop = 0; }, 0); }, true);
  const press = (tab) => { for (const type of ["pointerdown", "mousedown", "pointerup", "mouseup", "click"])
    tab.dispatchEvent(type.startsWith("pointer") ? pointer(type) : new MouseEvent(type, { bubbles: true, button: 0 })); };
  const edge = () => at('[data-dock-region-resize="left"]');
  const left = () => { const grip = edge(); return grip && grip.parentElement; };
  // The pointer of the user moves nothing meanwhile, which is seconds where a page is drawn slowly.
  let resizing = false;
  addEventListener("pointermove", (event) => { if (resizing && event.isTrusted) event.stopImmediatePropagation(); }, true);
  const resize = (width) => { const grip = edge(); if (!grip) return; const strip = grip.firstElementChild || grip, x = left().getBoundingClientRect().width;
    if (Math.abs(x - width) < 2) return;
    resizing = true;
    const moved = (type, at_) => new PointerEvent(type, { bubbles: true, button: 0, buttons: 1, pointerId: 1, isPrimary: true, clientX: at_, clientY: 300 });
    strip.dispatchEvent(moved("pointerdown", x)); window.dispatchEvent(moved("pointermove", width));
    requestAnimationFrame(() => requestAnimationFrame(() => { resizing = false; window.dispatchEvent(moved("pointerup", width)); })); };
  // The style sheet shares out the height of the left docks until somebody moves their border: viser begins from what is seen then.
  addEventListener("pointerdown", (event) => { const border = event.isTrusted && event.target.closest('[data-dock-region="left"] [data-dock-divider="column"]');
    const docks = border ? [border.previousElementSibling, border.nextElementSibling] : [];
    if (!border || docks.some((dock) => !dock || dock.style.flexGrow !== "0.5")) return;
    const [upper, lower] = docks.map((dock) => dock.getBoundingClientRect().height), whole = border.parentElement.getBoundingClientRect().height;
    const moved = (type, at_) => new PointerEvent(type, { bubbles: true, button: 0, buttons: 1, pointerId: 0, isPrimary: true, clientX: event.clientX, clientY: at_ });
    border.dispatchEvent(moved("pointerdown", 0)); const by = whole * (upper / (upper + lower) - 0.5);
    window.dispatchEvent(moved("pointermove", by)); window.dispatchEvent(moved("pointerup", by)); }, true);
  addEventListener("pointerup", () => setTimeout(() => { if (!restored) return;
    const side = left(); if (side && innerWidth > 1000) { const width = Math.round(side.getBoundingClientRect().width); if (width > 60) keep("width", width); } }, 400), true);
  addEventListener("click", () => setTimeout(() => { if (restored)
    keep("tabs", strips().map((list) => (at("[role=tab][aria-selected=true]", list) || {}).textContent).filter(Boolean).map((text) => text.trim())); }, 100), true);
  new MutationObserver(() => { if (isDark()) darkens = 0;
    if (restored && !darkens) { keep("dark", isDark()); document.documentElement.classList.toggle("pd-night", isDark()); } })
    .observe(document.documentElement, { attributes: true, attributeFilter: ["data-mantine-color-scheme"] });

  // The camera: above the floor, and with the whole arm and the tables in the picture until somebody moves it. viser's client hands
  // out its camera and nodes; its picture has y upwards.
  const FLAT = Math.PI / 2 - 0.03, SEEN = 0.84, SEEN_TABLE = 0.95, WIDE = 1, FRAMINGS = 6, POINTS = 250, BESIDE = 24, BESIDE_FINGER = 40;
  const viewer = () => { const it = window.__viserMutable; return it && it.camera && it.cameraControl ? it : null; };
  const inPicture = (target) => Boolean(target.closest && target.closest("canvas"));
  const ARM = /^\/arm\/[^/]+$/, WORLD = /^\/world\/\d+$/;
  // Calls `see` with points of what is named so: 0 in the middle of the picture, 1 at its border; true of one of them ends it.
  const over = (named, see) => { const { nodeRefFromName, camera } = viewer(), point = camera.position.clone();
    return Object.entries(nodeRefFromName).some(([name, node]) => { let met = false;
      if (node && named.test(name)) node.traverse((part) => { const shape = part.isMesh && part.geometry.attributes.position; if (met || !shape) return;
        if (!part.geometry.boundingSphere) part.geometry.computeBoundingSphere();
        if (part.geometry.boundingSphere.radius * part.matrixWorld.getMaxScaleOnAxis() > WIDE) return; // a plane has no end
        for (let i = 0, step = Math.max(1, Math.floor(shape.count / POINTS)); i < shape.count && !met; i += step)
          met = see(point.fromBufferAttribute(shape, i).applyMatrix4(part.matrixWorld).project(camera)); });
      return met; }); };
  const widest = (named) => { let most = 0; over(named, (point) => { most = Math.max(most, Math.abs(point.x), Math.abs(point.y)); return false; }); return most; };
  let above = null, framings = FRAMINGS, framed = "", measuring = false, nearest = 0;
  const look = () => { const it = viewer(); if (!it || !it.canvas) return;
    const control = it.cameraControl, { width, height } = it.canvas.getBoundingClientRect(), size = `${width} ${height} ${Object.keys(it.nodeRefFromName).filter((name) => WORLD.test(name))}`;
    if (control !== above) { above = control; const target = it.camera.position.clone();
      control.maxPolarAngle = FLAT;
      control.addEventListener("update", () => { control.getTarget(target); if (target.y < 0) control.moveTo(target.x, 0, target.z, false); }); }
    if (framed !== size && framings >= 0) { framed = size; framings = FRAMINGS; }
    if (framings <= 0 || !width || measuring) return;
    measuring = true; // once what was moved last has been drawn
    requestAnimationFrame(() => requestAnimationFrame(() => { measuring = false;
      const arm = framings > 0 && viewer() === it && widest(ARM); if (!arm) return;
      const beyond = Math.max(arm / SEEN, widest(WORLD) / SEEN_TABLE), far = control.distance;
      if (framings === FRAMINGS) nearest = far;
      framings -= 1; control.dollyTo(Math.max(nearest, far * Math.min(Math.max(beyond, 0.6), 1.6)), false); })); };
  const reframe = () => { const it = viewer(); if (!it) return; it.resetCameraPose(true); framings = FRAMINGS; };
  for (const name of ["pointerdown", "wheel"]) addEventListener(name, ({ target }) => { if (inPicture(target)) framings = -1; }, { capture: true, passive: true });
  // viser asks for the default of a press on the arm to be left out where that is not to be had, which the browser tells as an error.
  addEventListener("pointerdown", (event) => { if (inPicture(event.target)) event.preventDefault = () => {}; }, true);
  // A press that has only just missed the arm, which may move, is meant for it: the camera stays until it is lifted.
  let pressing = 0;
  addEventListener("pointerdown", ({ target, clientX, clientY, button, pointerType }) => { const it = viewer(); if (!it || button || !inPicture(target)) return;
    const { left, top, width, height } = it.canvas.getBoundingClientRect(), room = pointerType === "touch" ? BESIDE_FINGER : BESIDE;
    const x = clientX - left, y = clientY - top;
    if (!over(ARM, (point) => Math.hypot(width * (point.x + 1) / 2 - x, height * (1 - point.y) / 2 - y) < room)) return;
    pressing += 1; it.cameraControl.enabled = false; }, true);
  for (const name of ["pointerup", "pointercancel"]) addEventListener(name, () => { const it = pressing && viewer(); if (!it) return;
    pressing = 0; setTimeout(() => { if (!pressing) it.cameraControl.enabled = true; }, 0); }, true);
  // Over the picture: the way back to the first view, and what the ghosts in it mean.
  const view = () => { const picture = at(".pd-picture"); if (!picture) return; let box = at("#pd-view");
    if (!box || box.parentElement !== picture) { if (box) box.remove(); box = made("div", "pd-view", "group"); box.setAttribute("aria-label", "View");
      const button = Object.assign(document.createElement("button"), { type: "button", textContent: "Reset view" }); button.addEventListener("click", reframe);
      box.append(document.createElement("div"), button); picture.append(box); }
    const told = at(".pd-ghosts"), shown = box.firstChild, wanted = told ? told.innerHTML : "";
    if (shown.dataset.told !== wanted) { shown.dataset.told = wanted; shown.replaceChildren(...(told ? [...told.children].map((one) => one.cloneNode(true)) : [])); } };

  // Where the stop is folded away, as on the small screen of a phone, another one is in sight, which presses it or its key.
  const within = (node) => { const box = node && node.getBoundingClientRect(); return Boolean(box) && box.height > 1 && box.top >= 0 && box.bottom <= innerHeight + 1; };
  const spare = () => { let button = at("#pd-stop"); const needed = Boolean(beat) && !within(stop());
    if (needed && !button) { button = Object.assign(made("button", "pd-stop", ""), { type: "button", textContent: "EMERGENCY STOP" }); button.removeAttribute("role");
      button.addEventListener("pointerdown", () => { const real = stop(); if (real) real.click();
        else document.documentElement.dispatchEvent(new KeyboardEvent("keydown", { key: "x", code: "KeyX", bubbles: true })); });
      document.body.append(button); }
    if (button) button.hidden = !needed; };

  // The list of the program's steps has the height of its dock that what stands above and below it leaves, down to where steps are
  // inserted.
  let fitted = null, reached = "";
  const fit = () => { const list = at(".pd-steps"); if (!list || !list.offsetHeight) return;
    let box = list.parentElement; while (box && !/auto|scroll/.test(getComputedStyle(box).overflowY)) box = box.parentElement;
    const below = box && all("button", box).filter((one) => one.offsetHeight && /^(✕|After)$/.test(one.textContent.trim()));
    const last = below && (below.find((one) => one.textContent.trim() === "After") || below[0]); if (!last) return;
    const used = last.getBoundingClientRect().bottom - box.getBoundingClientRect().top + box.scrollTop - list.offsetHeight;
    document.documentElement.style.setProperty("--pd-steps", `${Math.floor(box.clientHeight - used - 8)}px`);
    // The step that is done, or the chosen one, is in sight when it becomes that, and when the list is drawn anew.
    const one = at(".pd-now", list) || at("[aria-checked=true]", list); if (!one || (list === fitted && one.textContent === reached)) return;
    fitted = list; reached = one.textContent;
    const { top, bottom } = one.getBoundingClientRect(), room = list.getBoundingClientRect();
    if (top < room.top) list.scrollTop -= room.top - top; else if (bottom > room.bottom) list.scrollTop += bottom - room.bottom; };

  // A script has the numbers of its lines beside it.
  const number = (text) => { let side = text.previousElementSibling; if (!side || !side.classList.contains("pd-lines")) { side = made("div", "", "presentation"); side.className = "pd-lines";
      side.setAttribute("aria-hidden", "true"); side.append(document.createElement("pre")); text.before(side); text.setAttribute("spellcheck", "false"); text.setAttribute("wrap", "off"); }
    const count = text.value.split("\n").length, lines = side.firstChild;
    if (lines.childElementCount !== count || side.dataset.count !== String(count)) { side.dataset.count = String(count); lines.textContent = Array.from({ length: count }, (_, i) => i + 1).join("\n"); }
    lines.style.transform = `translateY(${-text.scrollTop}px)`; };
  for (const name of ["input", "scroll"]) addEventListener(name, ({ target }) => { if (target.matches && target.matches("textarea.mantine-Textarea-input:not([aria-hidden])")) number(target); }, true);

  // Names for what viser leaves without one.
  const labelled = (control) => { for (let box = control.parentElement; box; box = box.parentElement) { const label = at("label", box); if (label) return label.textContent.trim(); if (box.childElementCount > 6) return ""; } return ""; };
  const set = (node, name, value) => { if (value && node.getAttribute(name) !== value) node.setAttribute(name, value); };
  const nameAll = () => {
    const side = left(); if (side) side.classList.add("pd-left");
    const canvas = at("canvas"), picture = canvas && canvas.closest('[style*="inset"]'); if (picture) picture.classList.add("pd-picture");
    if (canvas) { set(canvas, "role", "img"); set(canvas, "aria-label", "The arm. Drag a link to push it; with Shift to turn it."); }
    for (const slider of all("[role=slider]")) set(slider, "aria-label", labelled(slider));
    for (const input of all("input:not([type=hidden])")) if (!input.labels || !input.labels.length) set(input, "aria-label", input.placeholder || labelled(input));
    for (const group of all(".mantine-Button-root[data-size=compact-xs]")) { const text = group.textContent.trim();
      if (text.length < 2) set(group, "aria-label", `${labelled(group)}: ${{ "↑": "up", "↓": "down", "✕": "delete" }[text] || text}`); }
    for (const one of all(".mantine-Button-root[data-size=compact-xs]")) if (/^(TEACH|NORMAL)$/.test(one.textContent.trim()))
      set(one, "aria-pressed", String(one.textContent.trim() === mode()));
    // viser greets each file before anybody has looked into it: what became of it stands below the button.
    for (const note of all(".mantine-Notification-description")) { const text = note.firstChild;
      if (text && text.nodeValue === "File uploaded successfully.") text.nodeValue = "The file has arrived. What became of it stands below the button."; }
    // viser tells every page of a file that one of them sent, and pages that come later; only the sender knows its name.
    for (const title of all(".mantine-Notification-title")) if (title.textContent.startsWith("Uploading undefined")) title.closest(".mantine-Notification-root").style.display = "none";
    for (const fold of all('[aria-label="Collapse panel area"]')) set(fold, "title", "Fold this side away");
    for (const close of all(".mantine-Notification-closeButton")) set(close, "aria-label", "Close this message");
    all("button.mantine-ActionIcon-root:not([aria-label])").forEach((icon, i) => set(icon, "aria-label", i ? "Connection and view" : "Command palette"));
    for (const head of all('[style*="cursor: pointer"]')) { const next = head.nextElementSibling; if (head.tagName !== "DIV" || !next || !at("svg", head) || head.querySelector("input,button") || !/^(button)?$/.test(head.getAttribute("role") || "") || head.closest("[role=tablist]")) continue;
      const hidden = next.getBoundingClientRect().height < 2; set(head, "role", "button"); set(head, "tabindex", "0"); set(head, "aria-expanded", String(!hidden)); }
    for (const list of all("label[for]")) { const target = document.getElementById(list.htmlFor); if (target && target.getAttribute("role") === "presentation") target.removeAttribute("role"); }
    for (const text of all("textarea.mantine-Textarea-input:not([aria-hidden])")) number(text);
    // Marks lie along the track of their time line.
    for (const strip of all(".pd-marks")) { const line = document.getElementById(strip.dataset.pdLine), track = line && at(".mantine-Slider-trackContainer", line.parentElement); if (!track) continue;
      const room = strip.parentElement.getBoundingClientRect(), box = track.getBoundingClientRect();
      if (box.width) Object.assign(strip.style, { marginLeft: `${box.left - room.left}px`, width: `${box.width}px` }); }
    tell(); };
  addEventListener("keydown", (event) => { const head = event.target;
    if ((event.key === "Enter" || event.key === " ") && head.getAttribute && head.tagName === "DIV" && head.getAttribute("role") === "button") { event.preventDefault(); head.click(); } }, true);

  // A row of the event log is the choice of its moment; the pace says more when it is pressed.
  const option = (text) => all("[role=option]").find((one) => one.textContent.trim() === text);
  const picked = (target) => { const row = target.closest && target.closest("[data-pd-pick]"); if (!row) return;
    const one = option(row.getAttribute("data-pd-pick").trim()); if (one) one.click();
    if (!row.closest(".pd-log")) return;
    const plots = all("[role=tab]").find((tab) => tab.textContent.trim() === "Plots"); if (plots) press(plots); };
  addEventListener("click", (event) => { picked(event.target);
    if (event.target.closest && event.target.closest(".pd-pace")) document.documentElement.classList.toggle("pd-explain"); });
  addEventListener("keydown", (event) => { if ((event.key === "Enter" || event.key === " ") && event.target.matches && event.target.matches("[data-pd-pick]")) {
    event.preventDefault(); picked(event.target); } });

  // A step of the program is dragged to its place: by a mouse at once, by a finger that has rested on it; else it scrolls. The list
  // chooses the step and then its place: of two messages of a dock within 50 ms viser sends the last.
  const DRAGGED = 6, RESTED = 350, BETWEEN = 150;
  let row = null;
  const steps = () => all(".pd-steps [role=radio]");
  const place = (y) => steps().filter((one) => { const { top, height } = one.getBoundingClientRect(); return one !== row.node && y > top + height / 2; }).length;
  const drop = (done) => { if (!row) return; const { node, from, drags, to } = row; clearTimeout(row.rest); row = null;
    for (const one of steps()) one.classList.remove("pd-dragged", "pd-before", "pd-after");
    if (!done || !drags || to === from) return;
    const chosen = option(node.getAttribute("data-pd-pick").trim()); if (chosen) chosen.click();
    setTimeout(() => { const there = option(`to place ${to + 1}`); if (there) there.click(); }, BETWEEN); };
  const drag = (y) => { row.drags = true; row.node.classList.add("pd-dragged"); row.to = place(y);
    const others = steps().filter((one) => one !== row.node);
    for (const one of others) one.classList.remove("pd-before", "pd-after");
    if (row.to < others.length) others[row.to].classList.add("pd-before"); else if (others.length) others[others.length - 1].classList.add("pd-after"); };
  addEventListener("pointerdown", (event) => { const node = event.target.closest && event.target.closest(".pd-steps [role=radio]"); if (!node || event.button || row) return;
    row = { node, from: steps().indexOf(node), y: event.clientY, pointer: event.pointerId, finger: event.pointerType === "touch", drags: false, to: 0 };
    if (row.finger) row.rest = setTimeout(() => { if (row) drag(row.y); }, RESTED); });
  addEventListener("pointermove", (event) => { if (!row || event.pointerId !== row.pointer) return;
    if (row.drags || (!row.finger && Math.abs(event.clientY - row.y) > DRAGGED)) drag(event.clientY); });
  addEventListener("touchmove", (event) => { if (row && row.drags && event.cancelable) event.preventDefault(); }, { passive: false });
  addEventListener("pointerup", () => drop(true)); addEventListener("pointercancel", () => drop(false));

  // One live region: what the panel says in words. The element stays when its content changes.
  const tell = () => { let box = at(".pd-light"); while (box && !at(".pd-note", box)) box = box.parentElement;
    const note = box && at(".pd-note", box); if (note) { set(note.parentElement, "aria-live", "polite"); set(note.parentElement, "role", "status"); } };

  // A tour of five steps for who is new. A step is over when the page shows it, or by Next; it can be left at any time.
  const mode = () => (at(".pd-light b") || { textContent: "" }).textContent;
  const STEPS = [
    { title: "Push the arm", text: "Drag its last link. The arrow is the force of your hand; the arm holds its place." },
    { title: "Free it", text: "Hold the blue button for a second, then hands off until the check is over.", aim: freeDrive, over: () => mode() === "FREE-DRIVE" },
    { title: "Guide it", text: "Drag the arm again: it follows. Register waypoint, on the tab Teach, keeps a posture." },
    { title: "Let it be", text: "Wait, or press Leave free-drive. The ring at the button shows what is left.", aim: freeDrive, over: () => mode() === "TEACH" },
    { title: "Stop it", text: "Press EMERGENCY STOP or the key X. The panel says why it stands; then press Reset.", aim: stop, over: () => mode() === "STOP" } ];
  let step = -1, acted = false;
  addEventListener("pointerdown", (event) => { const button = event.target.closest && event.target.closest("button[id]");
    if (button && !button.disabled && (held(button) || button.textContent.trim() === "Register waypoint")) acted = true; }, true);
  const leave = () => { step = -1; keep("toured", true); tour(); };
  const tour = () => { const card = at("#pd-tour"); if (!card) return;
    for (const aimed of all(".pd-aim")) aimed.classList.remove("pd-aim");
    if (kept.toured && step < 0) { card.remove(); return; }
    card.replaceChildren();
    const button = (text, act) => { const one = Object.assign(document.createElement("button"), { type: "button", textContent: text }); one.addEventListener("click", act); return one; };
    if (step < 0) { card.append(button("New here? Five steps", () => { step = 0; tour(); }), button("No, thanks", leave)); return; }
    const one = STEPS[step], last = step === STEPS.length - 1;
    const title = Object.assign(document.createElement("b"), { textContent: `${step + 1} of ${STEPS.length}: ${one.title}` });
    card.append(title, Object.assign(document.createElement("p"), { textContent: one.text }),
      button(last ? "Done" : "Next", () => { if (last) leave(); else { step += 1; tour(); } }));
    if (!last) card.append(button("Leave the tour", leave));
    const aim = one.aim && one.aim(); if (aim) aim.classList.add("pd-aim"); };
  let was = false;
  const advance = () => {
    if (step < 0 && at("#pd-tour") && (acted || mode() === "FREE-DRIVE" || mode() === "RUN")) { leave(); return; } // who acts needs no offer
    const one = STEPS[step]; if (!one || !one.over) { was = false; return; }
    const over = one.over(); if (over && was === false && step < STEPS.length - 1) { step += 1; tour(); was = Boolean(STEPS[step].over && STEPS[step].over()); } };

  addEventListener("DOMContentLoaded", () => {
    const skip = Object.assign(document.createElement("a"), { href: "#", className: "pd-skip", textContent: "Skip to the stop (or key X)" });
    skip.addEventListener("click", (event) => { event.preventDefault(); const button = stop(); if (button) button.focus(); });
    const reload = Object.assign(document.createElement("button"), { type: "button", textContent: "Reload", hidden: true });
    reload.addEventListener("click", () => location.reload());
    const lost = made("div", "pd-lost", "alert"); lost.append(document.createElement("span"), reload);
    document.body.prepend(skip, lost);
    setInterval(() => { nameAll(); listen(); advance(); look(); view(); spare(); fit(); }, BEAT); });
})();
