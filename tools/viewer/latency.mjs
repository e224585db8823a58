#!/usr/bin/env node
// Measures the viewer while a drag turns the scene: images a second, and the time from a motion of the pointer to the pixels on
// the canvas of headless Chromium.
//
//   npm install playwright-core      (with Chromium or Chrome of the system; CHROMIUM names it)
//   tools/viewer/latency.mjs [--stages] target/release/spherule FILE [OPTIONS of view]...
//
// Without a browser, to the arrival of the image, in Node 22 or in `node --experimental-websocket` of version 20:
//
//   tools/viewer/latency.mjs --socket [--stages] target/release/spherule FILE [OPTIONS of view]...
//
// With --link 20,40, the page is at the other end of a link of 20 Mbit/s, on which everything takes 40 ms there and back.
//
// Each command that a page sends has a number, and each image tells the last command that it follows. With --stages a table says
// where the time goes from that command on: it waits for the last render, is rendered, waits for the page, is encoded, travels
// both ways, is decoded and drawn; and how much processor time an image takes (on Linux), which other programs do not change.
import { spawn } from "node:child_process";
import { readdirSync, readFileSync } from "node:fs";
import { createInterface } from "node:readline";
import { createRequire } from "node:module";
import { connect, createServer } from "node:net";
import path from "node:path";

const words = process.argv.slice(2);
const flags = new Set();
let link = null;
while (words[0]?.startsWith("--")) {
  flags.add(words[0]);
  if (words.shift() === "--link") link = words.shift().split(",").map(Number);
}
const server = spawn(words[0], ["view", "--no-browser", ...words.slice(1)], { stdio: ["ignore", "pipe", "inherit"] });
const opened = performance.now();
let address = await new Promise((resolve) => createInterface(server.stdout).once("line", resolve));
const through = link && (await linked(new URL(address)));
if (through) address = address.replace(/:\d+\//, `:${through.address().port}/`);
const SIZE = { width: 1280, height: 720 }, SECONDS = 8;
try {
  report(await (flags.has("--socket") ? overSocket() : inBrowser()));
} finally {
  server.kill();
  through?.close();
  if (through) setTimeout(() => process.exit(), 100);
}

/** A server that passes on what comes and goes as a slow link does, in both directions by itself. */
async function linked({ hostname, port }) {
  const [megabits, milliseconds] = link;
  const pass = (from, to, way) => {
    const waiting = [];
    let held = 0;
    from.on("data", (data) => {
      const now = performance.now();
      way.free = Math.max(now, way.free) + (data.length * 8) / (megabits * 1000);
      held += data.length;
      waiting.push(data);
      // Routers hold little.
      if (held > 64 << 10) from.pause();
      setTimeout(() => {
        // In their order, whatever the clock says.
        const first = waiting.shift();
        held -= first.length;
        if (held <= 64 << 10) from.resume();
        if (!to.destroyed) to.write(first);
      }, way.free + milliseconds / 2 - now);
    });
    // After what is still on its way.
    from.on("error", () => {}).on("close", () => setTimeout(() => to.end(), Math.max(0, way.free - performance.now()) + milliseconds));
  };
  const [up, down] = [{ free: 0 }, { free: 0 }];
  const own = createServer((page) => {
    const program = connect({ host: hostname, port: Number(port), noDelay: true });
    page.setNoDelay(true);
    pass(page, program, up);
    pass(program, page, down);
  });
  await new Promise((resolve) => own.listen(0, "127.0.0.1", resolve));
  return own;
}

/** Position of the pointer from the middle of the image, in a step of the drag. */
function motion(step) {
  return [200 * Math.sin(step / 40), 60 * Math.sin(step / 70)];
}

async function inBrowser() {
  const { chromium } = createRequire(path.join(process.cwd(), "x.js"))("playwright-core");
  const quiet = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: quiet });
  // The panel and the line below take the rest.
  const page = await browser.newPage({ viewport: { width: SIZE.width + 320, height: SIZE.height + 31 } });
  await page.goto(address);
  await page.waitForFunction(() => document.getElementById("image").dataset.picture, null, { timeout: 120_000 });
  const first = performance.now() - opened;
  await page.waitForTimeout(1000);
  let used = null;
  await page.exposeFunction("begin", () => (used = processors()));
  await page.exposeFunction("end", () => (used = since(used)));
  const figures = await page.evaluate(async ([source, limit]) => {
    const motion = eval(`(${source})`);
    const { left, top, width, height } = document.getElementById("stage").getBoundingClientRect();
    const canvas = document.getElementById("image"), { measured } = document.getElementById("view");
    const fire = (type, x, y) => canvas.dispatchEvent(new PointerEvent(type, { clientX: left + width / 2 + x, clientY: top + height / 2 + y, pointerId: 1, button: 0, bubbles: true, pointerType: "touch" }));
    canvas.setPointerCapture = () => {};
    fire("pointerdown", 0, 0);
    window.begin();
    const before = measured.length, start = performance.now();
    for (let step = 0; performance.now() - start < 1000 * limit; step += 1) {
      fire("pointermove", ...motion(step));
      await new Promise((resolve) => setTimeout(resolve, 16));
    }
    const seconds = (performance.now() - start) / 1000;
    window.end();
    fire("pointerup", 0, 0);
    return { width, height, seconds, images: measured.slice(before) };
  }, [motion.toString(), SECONDS]);
  await browser.close();
  return { first, used, ...figures };
}

async function overSocket() {
  const socket = new WebSocket(new URL("socket", address.replace(/^http/, "ws")));
  socket.binaryType = "arraybuffer";
  await new Promise((resolve) => (socket.onopen = resolve));
  let sent = 0, waiting = [], images = [], arrived = null;
  const send = (line) => {
    socket.send(line);
    waiting.push([(sent += 1), performance.now()]);
  };
  const showing = new Promise((resolve) => (arrived = resolve));
  socket.onmessage = ({ data }) => {
    if (typeof data === "string") return;
    const now = performance.now();
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, new DataView(data).getUint32(0, true))));
    socket.send(`shown ${header.picture}`);
    const followed = waiting.filter(([number]) => number <= header.heard).map(([, time]) => now - time);
    waiting = waiting.slice(followed.length);
    if (followed.length) images.push({ since: followed, times: header.times, size: [header.width, header.height] });
    if (header.width === SIZE.width) arrived();
  };
  send(`size ${SIZE.width}x${SIZE.height}`);
  await showing;
  const first = performance.now() - opened;
  const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));
  await pause(1000);
  send(`press ${SIZE.width / 2},${SIZE.height / 2}`);
  images = [];
  const before = processors(), start = performance.now();
  for (let step = 0; performance.now() - start < 1000 * SECONDS; step += 1) {
    const [x, y] = motion(step);
    send(`move ${SIZE.width / 2 + x},${SIZE.height / 2 + y}`);
    await pause(16);
  }
  const seconds = (performance.now() - start) / 1000, found = images, used = since(before);
  socket.close();
  return { first, used, ...SIZE, seconds, images: found };
}

/** Milliseconds of processor time of the program, and of the browser: of all others that this process started. */
function processors() {
  const all = new Map();
  for (const id of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
    try {
      const fields = readFileSync(`/proc/${id}/stat`, "utf8").replace(/^.*\) /s, "").split(" ");
      all.set(Number(id), { parent: Number(fields[1]), time: 10 * (Number(fields[11]) + Number(fields[12])) });
    } catch {
      // It has ended.
    }
  }
  const isOwn = (id) => id === process.pid || (all.has(id) && isOwn(all.get(id).parent));
  const times = { program: all.get(server.pid)?.time ?? 0, browser: 0 };
  for (const [id, { time }] of all) if (id !== server.pid && id !== process.pid && isOwn(id)) times.browser += time;
  return times;
}

function since(before) {
  const now = processors();
  return { program: now.program - before.program, browser: now.browser - before.browser };
}

function report({ first, used, width, height, seconds, images }) {
  const share = (values, part) => {
    const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
    return sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))] ?? NaN;
  };
  const since = images.flatMap((image) => image.since);
  console.log(`page ${width} x ${height}; first image ${(first / 1000).toFixed(2)} s after the start`);
  console.log(`${(images.length / seconds).toFixed(1)} images a second; motion to pixels: median ${share(since, 0.5).toFixed(1)} ms, 95th percentile ${share(since, 0.95).toFixed(1)} ms`);
  if (!flags.has("--stages") || !images.length) return;
  console.log(`size of images: median ${share(images.map(({ size }) => size[0]), 0.5)} x ${share(images.map(({ size }) => size[1]), 0.5)}`);
  const stages = images.map(({ since, times }) => {
    const known = Object.values(times).reduce((sum, time) => sum + time, 0);
    const { decode, draw, ...server } = times;
    return { ...server, travel: since.at(-1) - known, decode, draw, total: since.at(-1) };
  });
  for (const name of Object.keys(stages[0] ?? {})) {
    const values = stages.map((stage) => stage[name]);
    if (values.some((value) => value != null)) {
      console.log(`  ${name.padEnd(8)} median ${share(values, 0.5).toFixed(1).padStart(6)} ms, 95th percentile ${share(values, 0.95).toFixed(1).padStart(6)} ms`);
    }
  }
  const each = (time) => (time / images.length).toFixed(1);
  console.log(`processor time of an image: program ${each(used.program)} ms, browser ${each(used.browser)} ms`);
}
