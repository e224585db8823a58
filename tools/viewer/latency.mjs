#!/usr/bin/env node
// Measures the viewer in headless Chromium: pictures a second, and the time from a motion of the pointer to the pixels on the
// canvas, while a drag turns the scene.
//
//   npm install playwright-core      (with Chromium or Chrome of the system; CHROMIUM names it)
//   tools/viewer/latency.mjs target/release/spherule FILE [OPTIONS of view]...
//
// Each command that a page sends has a number, and each image tells the last command that it follows.
import { spawn } from "node:child_process";
import { createInterface } from "node:readline";
import { createRequire } from "node:module";
import path from "node:path";

const { chromium } = createRequire(path.join(process.cwd(), "x.js"))("playwright-core");
const [program, ...words] = process.argv.slice(2);
const server = spawn(program, ["view", "--no-browser", ...words], { stdio: ["ignore", "pipe", "inherit"] });
const opened = performance.now();
const address = await new Promise((resolve) => createInterface(server.stdout).once("line", resolve));
const quiet = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: quiet });
const page = await browser.newPage({ viewport: { width: 1600, height: 751 } });
await page.goto(address);
await page.waitForFunction(() => document.getElementById("image").dataset.picture, null, { timeout: 120_000 });
const first = performance.now() - opened;
await page.waitForTimeout(1000);
const figures = await page.evaluate(async () => {
  const { left, top, width, height } = document.getElementById("stage").getBoundingClientRect();
  const canvas = document.getElementById("image"), { measured } = document.getElementById("view");
  const fire = (type, x, y) => canvas.dispatchEvent(new PointerEvent(type, { clientX: left + x, clientY: top + y, pointerId: 1, button: 0, bubbles: true, pointerType: "touch" }));
  canvas.setPointerCapture = () => {};
  fire("pointerdown", width / 2, height / 2);
  const before = measured.length;
  const start = performance.now();
  for (let step = 0; performance.now() - start < 8000; step += 1) {
    fire("pointermove", width / 2 + 200 * Math.sin(step / 40), height / 2 + 60 * Math.sin(step / 70));
    await new Promise((resolve) => setTimeout(resolve, 16));
  }
  const seconds = (performance.now() - start) / 1000;
  fire("pointerup", width / 2, height / 2);
  const shown = measured.slice(before);
  return { width, height, seconds, pictures: shown.length, latencies: shown.flat() };
});
const sorted = figures.latencies.sort((a, b) => a - b);
const at = (share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))]?.toFixed(1);
console.log(`image ${figures.width} x ${figures.height}; first picture ${(first / 1000).toFixed(2)} s after the start`);
console.log(`${(figures.pictures / figures.seconds).toFixed(1)} pictures a second; motion to pixels: median ${at(0.5)} ms, 95th percentile ${at(0.95)} ms`);
await browser.close();
server.kill();
