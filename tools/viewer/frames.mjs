#!/usr/bin/env node
// Measures the viewer on a trajectory: the time to the first image, until the frames are counted, from a jump to the image of
// any frame, and how many frames a second are seen while they play, each one asked for when the image of the last one arrived.
//
//   tools/viewer/frames.mjs target/release/spherule FILE [OPTIONS of view]...
//
// It is a page without a browser, in Node 22 or in `node --experimental-websocket` of version 20. `trajectory.py` beside it
// writes files of any length.
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";

const JUMPS = 30, PLAYED = 30;
const [program, ...words] = process.argv.slice(2);
const server = spawn(program, ["view", "--no-browser", "--quiet", ...words], { stdio: ["ignore", "pipe", "inherit"] });
const opened = performance.now();
try {
  await measure(await new Promise((resolve) => createInterface(server.stdout).once("line", resolve)));
} finally {
  server.kill();
}

async function measure(address) {
  const socket = new WebSocket(new URL("socket", address.replace(/^http/, "ws")));
  socket.binaryType = "arraybuffer";
  await new Promise((resolve) => (socket.onopen = resolve));
  let sent = 0, state = {}, image = null, awaited = null;
  const send = (line) => {
    socket.send(line);
    sent += 1;
  };
  /** The time when something is true. */
  const until = (isSo) => new Promise((resolve) => {
    awaited = () => isSo() && resolve(performance.now());
    awaited();
  });
  socket.onmessage = ({ data }) => {
    if (typeof data === "string") {
      state = JSON.parse(data).state ?? state;
    } else {
      image = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, new DataView(data).getUint32(0, true))));
      socket.send(`shown ${image.picture}`);
    }
    awaited?.();
  };
  /** Goes to a frame; returns the milliseconds until an image of it arrived. */
  const show = async (frame) => {
    const start = performance.now();
    image = null;
    send(`frame ${frame}`);
    const number = sent;
    return (await until(() => image?.heard >= number && state.frame === frame && !state.busy)) - start;
  };
  send("size 1280x720");
  const first = (await until(() => image)) - opened;
  const counted = (await until(() => state.frames > 1)) - opened;
  console.log(`first image after ${(first / 1000).toFixed(2)} s, ${state.frames} frames counted after ${(counted / 1000).toFixed(2)} s`);
  const jumps = [];
  for (let jump = 1; jump <= JUMPS; jump += 1) jumps.push(await show(Math.floor((state.frames - 1) * ((jump * 0.618034) % 1))));
  console.log(`last frame after ${(await show(state.frames - 1)).toFixed(0)} ms`);
  jumps.sort((a, b) => a - b);
  console.log(`any frame after ${jumps[JUMPS >> 1].toFixed(0)} ms at the median, ${jumps.at(-1).toFixed(0)} ms at most`);
  for (const frame of [0, 1, 2]) await show(frame);
  const [start, before] = [performance.now(), processor()];
  for (let frame = 3; frame < PLAYED + 3; frame += 1) await show(frame % state.frames);
  const seconds = (performance.now() - start) / 1000;
  console.log(`${(PLAYED / seconds).toFixed(1)} frames a second while they play, ${((processor() - before) / PLAYED).toFixed(0)} ms of processor time each`);
  socket.close();
}

/** Milliseconds of processor time of the program. */
function processor() {
  const fields = readFileSync(`/proc/${server.pid}/stat`, "utf8").replace(/^.*\) /s, "").split(" ");
  return 10 * (Number(fields[11]) + Number(fields[12]));
}
