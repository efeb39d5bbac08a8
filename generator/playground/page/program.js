// The program, called as at a terminal: in the page, and once more in a worker for what takes long.
'use strict';

let program = null, printed = [], complained = [];

// One command: its exit status and what it printed.
function command(...line) {
  printed = [];
  complained = [];
  const status = program.ccall('play_command', 'number', ['string'], [line.join('\n')]);
  return { status, out: printed.join('\n'), err: complained.join('\n') };
}

const write = (name, text) => program.FS.writeFile(name, text);
const read = name => program.FS.readFile(name, { encoding: 'utf8' });

function forget(name) {
  try { program.FS.unlink(name); } catch (missing) { /* nothing was written */ }
}

// Models stand beside the law, where laws and paths find them; exercises in their folders.
function lay_down(file) {
  const name = file.name.replace(/^models\//, ''), folders = name.split('/').slice(0, -1);
  let at = '';
  for (const folder of folders) {
    at += folder;
    if (!program.FS.analyzePath(at).exists) program.FS.mkdir(at);
    at += '/';
  }
  write(name, file.text);
}

async function open_program(wasmBinary, files) {
  program = await load_perilat({
    print: line => printed.push(line), printErr: line => complained.push(line), wasmBinary,
  });
  files.forEach(lay_down);
}

if (typeof document === 'undefined')
  onmessage = async asked => {
    await open_program(asked.data.wasm, asked.data.files);
    postMessage(command(...asked.data.line));
  };
