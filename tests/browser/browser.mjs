// Headless Chromium over a pipe, with nothing but Node: its DevTools protocol, messages ended by a zero byte.
import { spawn } from 'node:child_process';
import { mkdtempSync } from 'node:fs';
import { rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

// No sandbox, as root in containers has none; nothing that looks for a network.
const FLAGS = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--hide-scrollbars', '--remote-debugging-pipe'];

export class Browser {
  constructor(program) {
    this.profile = mkdtempSync(join(tmpdir(), 'squeal-browser-'));
    this.process = spawn(program, [...FLAGS, `--user-data-dir=${this.profile}`], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
    this.waiting = new Map();
    this.listeners = [];
    this.last = 0;
    const chunks = [];
    this.process.stdio[4].on('data', chunk => {
      let start = 0;
      for (let end; (end = chunk.indexOf(0, start)) >= 0; start = end + 1) {
        chunks.push(chunk.subarray(start, end));
        this.receive(JSON.parse(Buffer.concat(chunks.splice(0)).toString()));
      }
      chunks.push(chunk.subarray(start));
    });
    this.process.on('exit', () => this.waiting.forEach(({ reject }) => reject(new Error('the browser has ended'))));
  }

  receive(message) {
    const { resolve, reject } = this.waiting.get(message.id) ?? {};
    this.waiting.delete(message.id);
    if (message.error) reject?.(new Error(message.error.message));
    else if (resolve) resolve(message.result);
    else this.listeners.forEach(listener => listener(message));
  }

  send(method, params = {}, sessionId = undefined) {
    const id = ++this.last;
    this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }

  async open(url) {
    const { targetId } = await this.send('Target.createTarget', { url: 'about:blank' });
    const { sessionId } = await this.send('Target.attachToTarget', { targetId, flatten: true });
    const page = new Page(this, sessionId);
    await page.start(url);
    return page;
  }

  async close() {
    const ended = new Promise(resolve => this.process.on('exit', resolve));
    this.process.kill();
    await ended;
    // Children of the browser may still write: the asynchronous one tries again, the other gives up.
    await rm(this.profile, { recursive: true, force: true, maxRetries: 20, retryDelay: 200 });
  }
}

class Page {
  constructor(browser, session) {
    this.send = (method, params) => browser.send(method, params, session);
    // What a page must not do: complain, throw, or ask for anything but itself.
    this.complaints = [];
    this.requests = [];
    browser.listeners.push(({ method, params, sessionId }) => {
      if (sessionId !== session) return;
      if (method === 'Runtime.exceptionThrown') this.complaints.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
      if (method === 'Runtime.consoleAPICalled') this.complaints.push(`console.${params.type}: ${params.args.map(arg => arg.value).join(' ')}`);
      if (method === 'Log.entryAdded') this.complaints.push(`${params.entry.level}: ${params.entry.text}`);
      if (method === 'Network.requestWillBeSent') this.requests.push(params.request.url);
      if (method === 'Page.loadEventFired') this.loaded?.();
    });
  }

  async start(url) {
    for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await this.send(`${domain}.enable`);
    const loaded = new Promise(resolve => { this.loaded = resolve; });
    await this.send('Page.navigate', { url });
    await loaded;
  }

  // The value of an expression, or of what it promises, in the page.
  async value(expression) {
    const { result, exceptionDetails } = await this.send('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true });
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`);
    return result.value;
  }

  async key(key, modifiers = 0) {
    for (const type of ['keyDown', 'keyUp']) await this.send('Input.dispatchKeyEvent', { type, key, code: key, modifiers });
  }

  async view(width, height, scheme, motion = 'no-preference') {
    await this.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
    const features = [{ name: 'prefers-color-scheme', value: scheme }, { name: 'prefers-reduced-motion', value: motion }];
    await this.send('Emulation.setEmulatedMedia', { features });
  }

  // As on paper, or on a screen again.
  async printed(isPrinted) {
    await this.send('Emulation.setEmulatedMedia', { media: isPrinted ? 'print' : '' });
    await this.value(`window.dispatchEvent(new Event('${isPrinted ? 'beforeprint' : 'afterprint'}'))`);
  }

  // The bytes of a PDF of A4 pages.
  async pdf() {
    const { data } = await this.send('Page.printToPDF', { paperWidth: 8.27, paperHeight: 11.69, printBackground: false });
    return Buffer.from(data, 'base64');
  }

  async picture() {
    const { cssContentSize: { width, height } } = await this.send('Page.getLayoutMetrics');
    const clip = { x: 0, y: 0, width, height: Math.min(height, 12000), scale: 1 };
    const { data } = await this.send('Page.captureScreenshot', { captureBeyondViewport: true, clip });
    return Buffer.from(data, 'base64');
  }
}
