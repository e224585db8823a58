// The page of `spherule view`: it shows images as they come, and sends commands, one a message, as scripts have them.

/** Shows a session in a document or a shadow root, which has the markup of index.html. `connect` is given what hears the
    session: `open`, `text`, `data` and `close`; it returns what sends it a line. */
function mount(root, connect) {
  const at = (id) => root.getElementById(id);
  const view = at("view"), stage = at("stage"), canvas = at("image"), context = canvas.getContext("2d", { alpha: false });

  /** What the session said last: keys, commands and options that there are, and the state of the view. */
  let hello = null, state = null;
  /** The last image's facts. */
  let shown = null;

  // Connection --------------------------------------------------------------------------------------------------------

  /** Number of commands that were sent, the times of those that no image follows yet, and for each image the milliseconds since
      the commands that it is the first to follow, those of its stages, and its size: for measurements. */
  let sent = 0, waiting = [];
  view.measured = [];

  function send(line) {
    if (!sendLine(line)) return;
    if (!/^(shown|hover|download|steer)\b/.test(line)) waiting.push([(sent += 1), performance.now()]);
  }

  /** Quotes a word as scripts have it. */
  const quoted = (text) => `'${text.replaceAll("'", `'"'"'`)}'`;

  let pending = Promise.resolve();
  const sendLine = connect({
    open() {
      [sent, waiting] = [0, []];
      at("lost").hidden = true;
      resize();
    },
    text: (text) => receive(JSON.parse(text)),
    // One after another, in the order in which they come.
    data(data) {
      pending = pending.then(() => unpack(data)).catch((error) => toast(String(error)));
    },
    close: () => (at("lost").hidden = false),
  });

  /** Handles a message of text. */
  function receive(message) {
    if (message.hello) {
      const before = hello?.session;
      hello = message.hello;
      if (before && before !== hello.session) restored = state;
      if (before !== hello.session) build();
    }
    if (message.state) {
      if (restored && !message.state.busy && !message.state.loading && message.state.title) restore(message.state);
      state = message.state;
      // Of an image that is still to come, with it.
      if (state.picture === shown?.picture) drawOver(state.drawn);
      tell();
    }
    if ("hover" in message) showTip(message.hover);
    if (message.plot) plotted?.(message.plot);
    if ("rendering" in message) rendering?.(message.rendering);
    if (message.error) refuse(message.error);
  }

  /** The view of a session that was started again since. */
  let restored = null;

  /** Brings the view back. */
  function restore(now) {
    const before = restored;
    restored = null;
    if (before.title !== now.title) return;
    const same = (name) => JSON.stringify(before.options[name]) === JSON.stringify(now.options[name]);
    for (const name of new Set([...Object.keys(before.options), ...Object.keys(now.options)])) {
      if (same(name)) continue;
      const values = before.options[name];
      send(values ? `set ${name} ${values.map((value) => (value == null ? "" : quoted(value))).join(" ")}`.trimEnd() : `unset ${name}`);
    }
    if (before.frame !== now.frame) send(`frame ${before.frame}`);
    for (const name of before.hidden) send(`hide ${quoted(name)}`);
    send(`camera ${quoted(before.camera.line)}`);
  }

  /** Handles a message of a header and files: an image in tiles, or a file to keep. */
  async function unpack(data) {
    const length = new DataView(data).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
    let start = 4 + length;
    const arrived = performance.now();
    if (header.file) {
      rendering?.(null, header.command);
      return keep(header.file, new Blob([new Uint8Array(data, start)]));
    }
    const tiles = await Promise.all(header.tiles.map(async ([x, y, width, height, size]) => {
      const file = new Uint8Array(data, start, size);
      start += size;
      return { x, y, bitmap: await decode(file, header.kind) };
    }));
    const decoded = performance.now();
    if (canvas.width !== header.width || canvas.height !== header.height) {
      canvas.width = header.width;
      canvas.height = header.height;
    }
    for (const { x, y, bitmap } of tiles) {
      context.drawImage(bitmap, x, y);
      bitmap.close();
    }
    send(`shown ${header.picture}`);
    shown = header;
    drawOver(state?.picture === header.picture ? state.drawn : header.drawn);
    measure(header, { decode: decoded - arrived, draw: performance.now() - decoded });
    canvas.dataset.picture = header.picture;
    canvas.dataset.samples = header.samples;
    canvas.dataset.finished = header.finished;
    // Texts of each preview would take as long as the image.
    if (header.samples > 0) tellStatus();
    else telling ||= setTimeout(tellStatus, 250);
  }

  let telling = 0;

  /** Decodes a file of an image. */
  async function decode(data, type) {
    const colorSpaceConversion = "none";
    // Not in a page that comes unencrypted from another machine.
    if (!self.ImageDecoder) return createImageBitmap(new Blob([data], { type }), { colorSpaceConversion });
    // Blobs go through another process.
    const decoder = new ImageDecoder({ data, type, colorSpaceConversion });
    const { image } = await decoder.decode();
    decoder.close();
    return image;
  }

  function measure({ heard, times, width, height }, own) {
    const now = performance.now();
    const rest = waiting.findIndex(([number]) => number > heard);
    const followed = waiting.splice(0, rest < 0 ? waiting.length : rest);
    if (followed.length) view.measured.push({ since: followed.map(([, time]) => now - time), times: { ...times, ...own }, size: [width, height] });
    view.measured.splice(0, view.measured.length - 2000);
  }

  function keep(name, blob) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  }

  // Pointer -----------------------------------------------------------------------------------------------------------

  /** Pixels of the image for a pixel of the page. */
  const scale = () => window.devicePixelRatio || 1;

  /** The stage's place, which is measured when a drag starts: during it, that would take time for each motion. */
  let box = null;

  function resize() {
    box = stage.getBoundingClientRect();
    const { width, height } = box;
    // Nothing, while an output of a notebook is folded.
    if (width < 1) return;
    const side = (length) => Math.max(16, Math.round(length * scale()));
    send(`size ${side(width)}x${side(height)}`);
    send(`scale ${Math.min(8, Math.max(0.25, scale()))}`);
  }

  function place(event) {
    if (!box || pointers.size === 0) box = stage.getBoundingClientRect();
    const { left, top } = box;
    const round = (length) => Math.round(length * scale() * 100) / 100;
    return `${round(event.clientX - left)},${round(event.clientY - top)}`;
  }

  const held = (event) => [event.shiftKey && " shift", (event.ctrlKey || event.metaKey) && " ctrl", event.altKey && " alt"].filter(Boolean).join("");

  const pointers = new Map();
  let pinch = null, clicked = { time: 0, at: "" }, cut = null, hovering = 0;

  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    box = stage.getBoundingClientRect();
    pointers.set(event.pointerId, event);
    hideTip();
    if (pointers.size === 2) {
      send("release");
      pinch = span();
      return send(`press ${pinch.at} shift`);
    }
    if (pointers.size > 2) return;
    const [button] = [["left", "middle", "right"][event.button] ?? "left"];
    if (state?.cutting) cut = { from: event, to: event };
    send(`press ${place(event)} ${button}${held(event)}`);
  });

  canvas.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return hover(event);
    pointers.set(event.pointerId, event);
    if (pinch && pointers.size === 2) {
      const now = span();
      send(`move ${now.at}`);
      const steps = Math.log(now.length / pinch.length) / Math.log(1 / 0.88);
      if (Math.abs(steps) > 0.05) {
        send(`wheel ${steps.toFixed(3)} ${now.at}`);
        pinch = now;
      }
      return;
    }
    if (cut) {
      cut.to = event;
      drawCut();
    }
    send(`move ${place(event)}`);
  });

  function lift(event) {
    if (!pointers.delete(event.pointerId)) return;
    if (pointers.size > 0) return;
    pinch = null;
    cut = null;
    drawCut();
    send("release");
    const where = place(event);
    if (event.button === 0 && !event.shiftKey && event.timeStamp - clicked.time < 350 && near(where, clicked.at)) {
      send(`double-click ${where}`);
      clicked = { time: 0, at: "" };
    } else {
      clicked = { time: event.timeStamp, at: where };
    }
  }
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("pointerleave", () => hideTip());
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());

  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const unit = event.deltaMode === 1 ? 3 : event.deltaMode === 2 ? 1 : 100;
    const delta = event.deltaY || event.deltaX;
    send(`wheel ${(-delta / unit).toFixed(3)} ${place(event)}${event.shiftKey ? " shift" : ""}`);
  }, { passive: false });

  function near(a, b) {
    const [[ax, ay], [bx, by]] = [a, b].map((text) => text.split(",").map(Number));
    return Math.hypot(ax - bx, ay - by) < 6 * scale();
  }

  /** The middle and the length between two fingers. */
  function span() {
    const [a, b] = [...pointers.values()];
    const middle = { clientX: (a.clientX + b.clientX) / 2, clientY: (a.clientY + b.clientY) / 2 };
    return { at: place(middle), length: Math.max(1, Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY)) };
  }

  function drawCut() {
    const svg = at("cut");
    svg.replaceChildren();
    if (!cut) return;
    const { left, top, width, height } = stage.getBoundingClientRect();
    const [a, b] = [cut.from, cut.to].map((event) => [event.clientX - left, event.clientY - top]);
    const along = [b[0] - a[0], b[1] - a[1]], length = Math.hypot(...along);
    if (length < 1) return;
    const far = (width + height) / length;
    const [dx, dy] = [along[0] * far, along[1] * far];
    const corners = [[a[0] - dx, a[1] - dy], [a[0] + dx, a[1] + dy], [a[0] + dx - dy, a[1] + dy + dx], [a[0] - dx - dy, a[1] - dy + dx]];
    svg.append(shape("polygon", { points: corners.map((corner) => corner.join(",")).join(" ") }));
    svg.append(shape("line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1] }));
  }

  /** Draws over the image, which has nothing of it when it is saved: rings around selected spheres, and handles of slices. */
  function drawOver(drawn) {
    const aspect = canvas.width / canvas.height;
    drawMarks(drawn?.marks ?? [], aspect);
    const handles = drawn?.handles ?? [];
    while (at("handles").childElementCount < handles.length) at("handles").append(handle(at("handles").childElementCount));
    [...at("handles").children].forEach((own, index) => {
      own.hidden = !handles[index];
      if (own.hidden || own.held) return;
      own.where = handles[index];
      const { range, distance } = state?.slices[index] ?? { range: [0, 0], distance: 0 };
      Object.assign(own, { ariaValueMin: range[0], ariaValueMax: range[1], ariaValueNow: distance });
      putHandle(own, own.where[0], own.where[1], aspect);
    });
  }

  function putHandle(own, x, y, aspect) {
    own.style.left = `${100 * (0.5 + x / aspect)}%`;
    own.style.top = `${100 * (0.5 - y)}%`;
    own.style.rotate = `${Math.atan2(-own.where[3], own.where[2])}rad`;
  }

  /** A handle that moves a slice along its normal. */
  function handle(index) {
    const own = make("button", { type: "button", title: "Drag, or use the arrow keys, to move the slice" }, "↔");
    Object.assign(own, { role: "slider", ariaLabel: `Slice ${index + 1}` });
    const move = (distance) => send(`slice ${index} ${Number(distance.toPrecision(6))}`);
    own.onpointerdown = (event) => {
      own.setPointerCapture(event.pointerId);
      own.held = { x: event.clientX, y: event.clientY, distance: state.slices[index].distance };
    };
    own.onpointermove = (event) => {
      if (!own.held) return;
      const [x, y, right, up] = own.where, height = stage.clientHeight, steep = Math.hypot(right, up);
      const shift = ((event.clientX - own.held.x) * right - (event.clientY - own.held.y) * up) / height;
      // One that faces the eye hardly moves in the image.
      const { range } = state.slices[index];
      const by = shift / Math.max(steep, 0.2 / (range[1] - range[0]) || 1e-9) ** 2;
      const distance = Math.min(range[1], Math.max(range[0], own.held.distance + by));
      putHandle(own, x + (distance - own.held.distance) * right, y + (distance - own.held.distance) * up, canvas.width / canvas.height);
      move(distance);
    };
    own.onlostpointercapture = () => (own.held = null);
    own.onkeydown = (event) => {
      const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      event.stopPropagation();
      const { distance, range } = state.slices[index];
      move(Math.min(range[1], Math.max(range[0], distance + step * (range[1] - range[0]) / 50)));
    };
    return own;
  }

  function drawMarks(marks, aspect) {
    const svg = at("marks");
    svg.replaceChildren();
    if (!marks.length) return;
    const pixel = 1 / stage.clientHeight;
    svg.setAttribute("viewBox", `${-aspect / 2} -0.5 ${aspect} 1`);
    const rings = marks.map(([x, y, long, short, right, up]) => {
      const radii = [long, short].map((radius) => Math.max(radius + 2 * pixel, 5 * pixel));
      const [dx, dy] = [right * radii[0], -up * radii[0]];
      const arc = `A${radii} ${Math.atan2(-up, right) * 180 / Math.PI} 0 1`;
      return `M${x - dx} ${-y - dy}${arc} ${x + dx} ${-y + dy}${arc} ${x - dx} ${-y - dy}`;
    });
    svg.append(...["halo", "ring"].map((name) => shape("path", { class: name, d: rings.join("") })));
  }

  function shape(name, attributes) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return element;
  }

  /** Asks what is under the pointer once it rests. */
  function hover(event) {
    clearTimeout(hovering);
    hideTip();
    if (event.pointerType === "touch") return;
    hovering = setTimeout(() => {
      tipAt = event;
      send(`hover ${place(event)}`);
    }, 140);
  }

  let tipAt = null;
  function showTip(text) {
    if (!text || !tipAt) return;
    const { left, top, width } = stage.getBoundingClientRect();
    const tip = at("tip");
    tip.textContent = text;
    tip.hidden = false;
    const x = tipAt.clientX - left, y = tipAt.clientY - top;
    tip.style.left = x > width / 2 ? "" : `${x + 14}px`;
    tip.style.right = x > width / 2 ? `${width - x + 14}px` : "";
    tip.style.top = `${y + 14}px`;
  }
  function hideTip() {
    clearTimeout(hovering);
    tipAt = null;
    at("tip").hidden = true;
  }

  // Keys --------------------------------------------------------------------------------------------------------------

  const NAMES = { " ": "space", ArrowRight: "right", ArrowLeft: "left", ArrowUp: "up", ArrowDown: "down", PageDown: "page-down", PageUp: "page-up", Escape: "esc", Delete: "delete", Home: "home", F1: "f1" };

  root.addEventListener("keydown", (event) => {
    const control = event.ctrlKey || event.metaKey;
    const field = event.target.matches?.("input, select, textarea");
    if (field || event.target.closest?.("dialog") || !hello) return;
    let key = NAMES[event.key] ?? event.key;
    if (control) key = `ctrl+${event.shiftKey ? "shift+" : ""}${key.toLowerCase()}`;
    if (["?", "f1"].includes(key)) {
      event.preventDefault();
      return at("keys").showModal();
    }
    if (["q", "ctrl+q", "ctrl+w", "tab", "Tab"].includes(key)) return;
    if (key === "k") return toggleBar();
    if (!hello.bindings.includes(key)) return;
    // Buttons keep the keys that press them.
    if (event.target.matches("button, summary, a") && ["space", "Enter"].includes(key)) return;
    event.preventDefault();
    send(`key ${key}`);
  });

  let bar = true;
  function toggleBar() {
    bar = !bar;
    tellBar();
  }

  // State -------------------------------------------------------------------------------------------------------------

  const number = (value) => value.toLocaleString("en-US");

  function tell() {
    if (root === document) document.title = `${state.title} - Spherule`;
    at("title").textContent = state.title || "Spherule";
    at("undo").disabled = !state.undo;
    at("redo").disabled = !state.redo;
    at("slice").setAttribute("aria-pressed", state.cutting);
    canvas.style.cursor = state.cutting ? "crosshair" : "";
    at("steer").hidden = state.pages < 2;
    at("open").hidden = !canSend();
    at("open").title = canSend() ? `Open a particle file, of at most ${number(state.opens / 2 ** 20)} MiB; or drop it on the image` : "";
    const [text, done] = state.loading ?? [];
    at("loading").hidden = !text;
    if (text) {
      at("loading").firstElementChild.textContent = text;
      const progress = at("loading").lastElementChild;
      if (done == null) progress.removeAttribute("value");
      else progress.value = done;
    }
    const several = (state.frames ?? 0) > 1;
    at("frames").hidden = !several;
    if (several) {
      at("frame").max = state.frames - 1;
      if (root.activeElement !== at("frame") || playing) at("frame").value = state.frame;
      at("count").textContent = `${number(state.frame)} of ${number(state.frames)}`;
    }
    tellBar();
    tellStatus();
    for (const refresh of refreshers) refresh();
  }

  function tellStatus() {
    clearTimeout(telling);
    telling = 0;
    if (!state) return;
    const parts = [`${number(state.spheres)} spheres`];
    if (shown) {
      parts.push(shown.samples === 0 ? "preview" : `${number(shown.samples)} of ${number(state.samples)} samples`);
      if (shown.error != null) parts.push(`error ${(100 * shown.error).toFixed(2)} %${shown.denoised ? ", denoised" : ""}`);
      if (shown.rate) parts.push(`${(shown.rate / 1e6).toFixed(1)} Mrays/s`);
    }
    if (state.message) parts.push(state.message);
    at("status").textContent = parts.join(" · ");
  }

  function tellBar() {
    const legend = state?.legend;
    const figure = at("bar");
    figure.hidden = !legend || !bar;
    if (figure.hidden || figure.dataset.legend === JSON.stringify(legend)) return;
    figure.dataset.legend = JSON.stringify(legend);
    const caption = make("figcaption", {}, legend.label);
    const colors = make("div", { className: "colors" });
    for (const color of legend.colors) {
      const part = make("i");
      part.style.background = color;
      colors.append(part);
    }
    const ticks = make("div", { className: "ticks" });
    for (const [share, label] of legend.ticks) {
      const tick = make("span", {}, label);
      tick.style.bottom = `${100 * share}%`;
      ticks.append(tick);
    }
    figure.replaceChildren(caption, colors, ticks);
  }

  let fading = 0;
  function toast(text) {
    at("toast").textContent = text;
    at("toast").hidden = false;
    clearTimeout(fading);
    fading = setTimeout(() => (at("toast").hidden = true), 8000);
  }

  // Panel -------------------------------------------------------------------------------------------------------------

  /** Sections of the panel, with options of `render`; all others are in the last section. */
  const SECTIONS = [
    ["Particles", ["select", "hide", "model", "radii", "radius-scale", "bonds", "bond-radius", "polyhedra", "opacity"], true],
    ["Colors", ["color-by", "color-map", "color-range", "color-title", "color-log", "colors"], true],
    ["Styles", ["style"], true],
    ["Light and look", ["preset", "background", "depth-cue", "outline", "exposure", "integrator", "spp", "denoise"], false],
    ["Slices", ["slice", "slice-mode"], false],
    ["Cell", ["cell", "wrap", "replicate", "complete", "outside"], false],
    ["Annotations", ["legend", "color-bar", "axes", "scale-bar", "label", "measure"], false],
  ];

  const VIEWS = ["view", "look-at", "zoom", "roll", "projection", "up", "aperture", "focus"];
  const SIDES = [["Front", "1"], ["Back", "ctrl+1"], ["Right", "3"], ["Left", "ctrl+3"], ["Top", "7"], ["Bottom", "ctrl+7"], ["Isometric", "0"], ["Broadside", "9"], ["Perspective or not", "5"], ["Reset", "r"]];

  /** Functions that show the state in controls. */
  let refreshers = [];
  /** The row whose command was sent last. */
  let asked = null;

  /** Builds the panel from the options that there are. */
  function build() {
    refreshers = [];
    const options = new Map(hello.topics.flatMap(([, own]) => own.map((option) => [option.name, option])));
    const sections = SECTIONS.map(([title, names, open]) => section(title, open, names.map((name) => options.get(name)).filter(Boolean).map(control)));
    const listed = new Set([...VIEWS, ...SECTIONS.flatMap(([, names]) => names)]);
    const rest = hello.topics.flatMap(([topic, own]) => own.filter(({ name }) => !listed.has(name) && listed.add(name)).map((option) => control(option, topic)));
    const find = make("input", { type: "search", placeholder: "Find an option", ariaLabel: "Find an option" });
    find.oninput = () => {
      for (const row of rest) row.hidden = !row.textContent.includes(find.value.toLowerCase()) && !row.title.toLowerCase().includes(find.value.toLowerCase());
    };
    at("sections").replaceChildren(
      ...sections, camera(), section("Selected", true, selected()), section("Types", false, [types()]), save(), section("All other options", false, [find, ...rest]));
    const table = at("keys").querySelector("table");
    table.replaceChildren(...hello.keys.map(([keys, what]) => make("tr", {}, make("td", {}, keys), make("td", {}, what))));
  }

  function section(title, open, rows) {
    const element = make("details", { open: stored(title) ?? open }, make("summary", {}, title), ...rows);
    element.ontoggle = () => sessionStorage.setItem(`open ${title}`, element.open);
    return element;
  }
  const stored = (title) => {
    const value = sessionStorage.getItem(`open ${title}`);
    return value == null ? undefined : value === "true";
  };

  /** A row with the control of an option. */
  function control(option) {
    const id = `option-${option.name}`;
    const row = make("div", { className: "row", title: option.help ?? "" });
    const label = make("label", { htmlFor: id }, option.name);
    const set = (...values) => {
      ask(row, values.length ? `set ${option.name} ${values.map((value) => (value == null ? "" : quoted(value))).join(" ")}`.trimEnd() : `unset ${option.name}`);
    };
    const values = () => state?.options[option.name] ?? [];
    row.append(label, option.many ? list(option, id, values, set) : single(option, id, values, set));
    return refusing(row);
  }

  /** A row that shows why what it asked for is refused. */
  function refusing(row) {
    const why = make("div", { className: "why", hidden: true });
    row.append(why);
    row.refuse = (text) => {
      row.classList.toggle("bad", Boolean(text));
      why.hidden = !text;
      why.textContent = text ?? "";
    };
    return row;
  }

  /** Sends a command of a row. */
  function ask(row, line) {
    asked = row;
    row.refuse();
    send(line);
  }

  /** A control of one value. */
  function single(option, id, values, set) {
    if (option.flag) {
      const box = make("input", { type: "checkbox", id });
      box.onchange = () => (box.checked ? set(null) : set());
      refreshers.push(() => (box.checked = values().length > 0));
      return box;
    }
    if (option.values.length) {
      const choice = make("select", { id }, make("option", { value: "" }, "default"));
      choice.append(...option.values.map((value) => make("option", { value }, value)));
      // Keys change the look, too.
      const now = () => ({ "depth-cue": state.depth_cue ? "on" : "off", outline: state.outline ? "on" : "off" })[option.name] ?? values().at(-1) ?? (option.name === "preset" ? state.preset : null) ?? "";
      choice.onchange = () => (choice.value ? set(choice.value) : set());
      refreshers.push(() => (choice.value = now()));
      return choice;
    }
    const field = make("input", { id, placeholder: option.value ?? "", autocomplete: "off", spellcheck: false });
    const isText = () => field.value.trim() !== "";
    field.onchange = () => (isText() ? set(field.value.trim()) : set());
    if (option.name === "color-by") suggest(field, () => state.columns);
    const now = () => (option.optional && values().length && values().at(-1) == null ? "yes" : values().at(-1) ?? "");
    if (option.optional) field.onchange = () => (!isText() ? set() : field.value.trim() === "yes" ? set(null) : set(field.value.trim()));
    if (option.optional) field.placeholder = `yes, or ${option.value ?? ""}`;
    refreshers.push(() => {
      if (root.activeElement !== field) field.value = now();
    });
    return field;
  }

  /** A control of several values, one a field. */
  function list(option, id, values, set) {
    const entries = make("div", { className: "list" });
    const read = () => [...entries.querySelectorAll("input:not([type])")].map((input) => input.value.trim()).filter(Boolean);
    const entry = (value, index) => {
      const field = make("input", { value, id: index === 0 ? id : "", placeholder: option.value ?? "", autocomplete: "off", spellcheck: false, ariaLabel: `${option.name} ${index + 1}` });
      field.onchange = () => set(...read());
      const remove = make("button", { type: "button", title: "Remove", ariaLabel: `Remove ${option.name} ${index + 1}` }, "×");
      remove.onclick = () => {
        field.value = "";
        set(...read());
      };
      return make("div", { className: "entry" }, ...(value && option.name === "style" ? [eye(field)] : []), field, ...(value ? [remove] : []));
    };
    /** Shows or hides the particles of a style, by its property. */
    const eye = (field) => {
      const says = /\bvisible=(yes|no)\b/, hidden = says.exec(field.value)?.[1] === "no";
      const box = make("input", { type: "checkbox", checked: !hidden, title: "Visible", ariaLabel: `Visible: ${field.value}` });
      box.onchange = () => {
        const now = `visible=${box.checked ? "yes" : "no"}`;
        field.value = says.test(field.value) ? field.value.replace(says, now) : `${field.value} ${now}`;
        set(...read());
      };
      return box;
    };
    let before = null;
    refreshers.push(() => {
      const now = JSON.stringify(values());
      if (now === before) return;
      before = now;
      entries.replaceChildren(...[...values().map((value) => value ?? ""), ""].map(entry));
    });
    return entries;
  }

  function suggest(field, values) {
    const list = make("datalist", { id: `${field.id}-values` });
    field.setAttribute("list", list.id);
    field.onfocus = () => list.replaceChildren(...values().map((value) => make("option", { value })));
    at("sections").append(list);
    queueMicrotask(() => field.after(list));
  }

  /** Shows a refusal beside the control that asked, or else at the bottom. */
  function refuse(text) {
    if (asked?.isConnected) asked.refuse(text);
    else toast(text);
    asked = null;
  }

  function camera() {
    const sides = make("div", { className: "buttons" }, ...SIDES.map(([name, key]) => {
      const button = make("button", { type: "button", title: `Key ${key}` }, name);
      button.onclick = () => send(`key ${key}`);
      return button;
    }));
    const where = make("pre", { ariaLabel: "Position of the camera" });
    refreshers.push(() => {
      const { eye, target, fov, height } = state.camera;
      const point = (values) => values.map((value) => Number(value.toPrecision(6))).join(" ");
      where.textContent = `eye ${point(eye)}\ntarget ${point(target)}\n${fov == null ? `height ${Number((height ?? 0).toPrecision(6))}` : `field of view ${Number(fov.toPrecision(4))}°`}`;
    });
    const options = new Map(hello.topics.flatMap(([, own]) => own.map((option) => [option.name, option])));
    const element = section("Camera", false, [sides, where]);
    element.append(...VIEWS.map((name) => options.get(name)).filter(Boolean).map(control));
    return element;
  }

  /** The selected spheres, and what they measure. */
  function selected() {
    const rows = make("div", { className: "selected" });
    const field = make("input", { id: "pick", placeholder: "CONDITION", autocomplete: "off", spellcheck: false });
    const row = make("div", { className: "row", title: "Select the particles of a condition, as --select has it" }, make("label", { htmlFor: "pick" }, "pick"), field);
    suggest(field, () => state.columns);
    refusing(row);
    field.onchange = () => {
      ask(row, field.value.trim() ? `pick ${quoted(field.value.trim())}` : "pick");
    };
    let before = null;
    refreshers.push(() => {
      const now = JSON.stringify([state.picked, state.measures, state.options.measure]);
      if (now === before) return;
      before = now;
      const kept = state.options.measure ?? [];
      const measure = ({ text, periodic, option }) => {
        const value = make("output", { className: "measure" }, periodic ? `${text}, nearest images` : text);
        const over = make("button", { type: "button", hidden: (state.frames ?? 0) < 2, title: "Plot it over the frames" }, "Plot");
      over.onclick = () => send(periodic ? "plot periodic" : "plot");
      if (!option) return make("div", {}, value, over);
        const keep = make("button", { type: "button", disabled: kept.includes(option), title: "Draw it in the image, as --measure does" }, "Keep");
        keep.onclick = () => send(`set measure ${[...kept, option].map(quoted).join(" ")}`);
        return make("div", {}, value, keep, over);
      };
      const none = state.picked.length ? [] : [make("div", { className: "hint" }, "Click a sphere; with Shift, several: two to four have a distance, angle or dihedral.")];
      const described = state.picked.filter(({ text }) => text != null);
      const more = state.picked.length - described.length;
      const rest = more ? [make("div", { className: "hint" }, `and ${number(more)} more`)] : [];
      rows.replaceChildren(...none, ...described.map(({ text }) => make("div", {}, text)), ...rest, ...state.measures.map(measure));
    });
    return [row, rows, plot()];
  }

  /** Takes what is told of values over the frames. */
  let plotted = null;

  function plot() {
    const caption = make("figcaption"), line = shape("polyline", {}), now = shape("line", { y1: 0, y2: 100 });
    const svg = shape("svg", { viewBox: "0 0 300 100", preserveAspectRatio: "none", role: "img" });
    const figure = make("figure", { className: "plot", hidden: true }, caption, svg);
    let about = null, values = [];
    svg.append(line, now);
    const draw = () => {
      figure.hidden = !about;
      if (!about) return;
      const known = values.filter((value) => value != null), last = Math.max(1, about.frames - 1);
      const [low, high] = known.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
      const unit = about.unit === "°" ? "°" : about.unit && ` ${about.unit}`, short = (value) => Number(value.toPrecision(4));
      const range = known.length ? `${short(low)} to ${short(high)}${unit}` : "not there", here = values[state.frame];
      caption.textContent = `${about.title}: ${range}${here == null ? "" : `; frame ${number(state.frame)}: ${short(here)}${unit}`}${values.length < about.frames ? `; ${Math.round(100 * values.length / about.frames)} %` : ""}`;
      svg.setAttribute("aria-label", caption.textContent);
      const y = (value) => 96 - 92 * (high > low ? (value - low) / (high - low) : 0.5);
      // As many as can be told apart.
      const step = Math.max(1, Math.floor(values.length / 3000));
      line.setAttribute("points", values.map((value, frame) => (value == null || frame % step ? "" : `${300 * frame / last},${y(value)}`)).join(" "));
      for (const end of ["x1", "x2"]) now.setAttribute(end, 300 * state.frame / last);
    };
    svg.onclick = (event) => {
      const { left, width } = svg.getBoundingClientRect();
      send(`frame ${Math.round((about.frames - 1) * (event.clientX - left) / width)}`);
    };
    plotted = (told) => {
      if (told.title) [about, values] = [told, []];
      values.push(...(told.values ?? []));
      draw();
    };
    let before = null;
    refreshers.push(() => state.frame !== before && ((before = state.frame), draw()));
    return figure;
  }

  function types() {
    const rows = make("div", { className: "buttons" });
    let before = null;
    refreshers.push(() => {
      const now = JSON.stringify([state.types, state.hidden]);
      if (now === before) return;
      before = now;
      rows.replaceChildren(...state.types.map((name) => {
        const visible = !state.hidden.includes(name);
        const button = make("button", { type: "button", ariaPressed: String(visible), title: visible ? "Hide" : "Show" }, name);
        button.onclick = () => send(`${visible ? "hide" : "show"} ${quoted(name)}`);
        return button;
      }));
    });
    return rows;
  }

  /** Tells how far a file is that is rendered beside the view, or the command line that makes it. */
  let rendering = null;

  function save() {
    const field = (name, placeholder, title) => {
      const own = make("input", { id: `file-${name}`, placeholder, autocomplete: "off", spellcheck: false });
      return [own, make("div", { className: "row", title }, make("label", { htmlFor: own.id }, name), own)];
    };
    const [size, sizeRow] = field("size", "that of the page, or 3840x2160", "Width and height in pixels, or on paper, as in 85mm");
    const [quality, qualityRow] = field("samples or error", "as shown, or 256, or 1%", "Samples per pixel, or the error to reach");
    const chosen = () => [size.value.trim() && `size=${size.value.trim().replaceAll(" ", "")}`, quality.value.trim() && `${quality.value.includes("%") ? "until-error" : "spp"}=${quality.value.trim().replaceAll(" ", "")}`].filter(Boolean);
    const status = make("div", { role: "status", className: "hint" });
    const cancel = make("button", { type: "button", hidden: true }, "Cancel");
    cancel.onclick = () => send("download cancel");
    rendering = (text, command) => {
      cancel.hidden = text == null;
      status.textContent = text ?? (command ? `Saved, as by: ${command}` : "");
    };
    const files = make("div", { className: "buttons" }, ...["png", "jpg", "tif", "exr", "toml"].map((suffix) => {
      const button = make("button", { type: "button" }, suffix === "toml" ? "Scene (.toml)" : suffix.toUpperCase());
      button.onclick = () => send(["download", suffix, ...(suffix === "toml" ? [] : chosen())].join(" "));
      return button;
    }));
    const [line, python] = ["Command line", "Python"].map((name) => make("pre", { ariaLabel: name, tabIndex: 0 }));
    refreshers.push(() => {
      line.textContent = state.command ?? "";
      python.textContent = state.python ?? "";
    });
    return section("Save", false, [sizeRow, qualityRow, files, status, cancel, make("div", {}, "The command that makes this image:"), line, make("div", {}, "In Python:"), python]);
  }

  // Files -------------------------------------------------------------------------------------------------------------

  /** Whether files can be sent: to a view that was started without one, not from a notebook. */
  const canSend = () => root === document && state?.opens;
  at("open").onclick = () => at("file").click();
  at("file").onchange = () => at("file").files[0] && sendFile(at("file").files[0]);
  stage.ondragover = (event) => canSend() && event.preventDefault();
  stage.ondrop = (event) => {
    const [file] = event.dataTransfer.files;
    if (!canSend() || !file) return;
    event.preventDefault();
    sendFile(file);
  };

  async function sendFile(file) {
    if (file.size > state.opens) return toast(`${file.name} has more than ${number(state.opens / 2 ** 20)} MiB; open it by spherule view`);
    send(`open ${quoted(file.name)} ${file.size}`);
    const piece = 48 * 1024;
    for (let start = 0; start < file.size; start += piece) {
      if (!(await sendLine(await file.slice(start, start + piece).arrayBuffer()))) return toast("the connection was lost; open the file again");
      if (start % (64 * piece) === 0) at("status").textContent = `sending ${file.name}: ${Math.round(100 * start / file.size)} %`;
    }
  }

  for (const button of root.querySelectorAll("[data-line]")) {
    button.onclick = () => send(button.dataset.line);
  }
  at("help").onclick = () => at("keys").showModal();
  at("steer").onclick = () => send("steer");
  at("fold").onclick = () => {
    const folded = view.classList.toggle("folded");
    at("fold").setAttribute("aria-expanded", String(!folded));
  };

  // Frames ------------------------------------------------------------------------------------------------------------

  let playing = 0;
  at("frame").oninput = () => send(`frame ${at("frame").value}`);
  at("play").onclick = () => {
    playing = playing ? (clearInterval(playing), 0) : setInterval(advance, 1000 / Number(at("speed").value));
    at("play").setAttribute("aria-pressed", String(Boolean(playing)));
  };
  at("speed").onchange = () => {
    if (!playing) return;
    clearInterval(playing);
    playing = setInterval(advance, 1000 / Number(at("speed").value));
  };
  /** Goes to the next frame once the last one is shown. */
  function advance() {
    if (!state || state.loading || advance.frame === state.frame && advance.picture === canvas.dataset.picture) return;
    advance.picture = canvas.dataset.picture;
    advance.frame = state.frame;
    send(`frame ${(state.frame + 1) % state.frames}`);
  }

  const observer = new ResizeObserver(resize);
  observer.observe(stage);
  if (root !== document || view.clientWidth <= 700) at("fold").click();
  return () => {
    clearInterval(playing);
    observer.disconnect();
  };
}

/** Connects the page by a socket, again whenever it closes. */
function overSocket(hearing, wait = 250) {
  let socket = null;
  const open = () => {
    socket = new WebSocket(new URL("socket", location.href.replace(/^http/, "ws")));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      wait = 250;
      hearing.open();
    };
    socket.onmessage = ({ data }) => (typeof data === "string" ? hearing.text(data) : hearing.data(data));
    socket.onclose = () => {
      hearing.close();
      setTimeout(open, wait);
      wait = Math.min(2 * wait, 5000);
    };
  };
  open();
  return (line) => {
    if (socket.readyState !== WebSocket.OPEN) return false;
    socket.send(line);
    // Pieces of files wait for those before.
    return typeof line === "string" || drained(socket);
  };
}

async function drained(socket) {
  while (socket.bufferedAmount > 1 << 20) await new Promise((resolve) => setTimeout(resolve, 20));
  return socket.readyState === WebSocket.OPEN;
}

/** Shows the view in an output of a notebook, as anywidget calls it. */
function render({ model, el }) {
  const own = document.createElement("div");
  el.append(own);
  // Shortcuts of notebooks are not for the view.
  own.dataset.lmSuppressShortcuts = "true";
  for (const kind of ["keydown", "contextmenu", "wheel"]) own.addEventListener(kind, (event) => event.stopPropagation());
  const root = own.attachShadow({ mode: "open" });
  const parsed = new DOMParser().parseFromString(model.get("_markup"), "text/html");
  root.append(make("style", {}, model.get("_style")), document.adoptNode(parsed.getElementById("view")));
  let hear = null;
  const unmount = mount(root, (hearing) => {
    hear = ({ text, lost }, buffers) => {
      if (lost) hearing.close();
      else if (text != null) hearing.text(text);
      else hearing.data(buffer(buffers[0]));
    };
    model.on("msg:custom", hear);
    model.send({ line: "join" });
    queueMicrotask(hearing.open);
    return (line) => (model.send({ line }), true);
  });
  return () => {
    model.off("msg:custom", hear);
    unmount();
  };
}

/** The bytes of a view, which may be of a part of a buffer. */
const buffer = (view) => (view.buffer ?? view).slice(view.byteOffset ?? 0, (view.byteOffset ?? 0) + view.byteLength);

function make(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

if (document.documentElement.dataset.spherule === "page") mount(document, overSocket);
export default { render };
