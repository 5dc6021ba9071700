'use strict';
/** The state of the page in its address, behind #. */
const Link = (() => {
  const to_text = (bytes) =>
      btoa(String.fromCharCode(...bytes)).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
  const to_bytes = (text) =>
      Uint8Array.from(atob(text.replaceAll('-', '+').replaceAll('_', '/')), (letter) => letter.charCodeAt(0));
  const through = async (bytes, stream) =>
      new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());

  /** A text, packed for an address, and back. */
  const pack = async (text) =>
      to_text(await through(new TextEncoder().encode(text), new CompressionStream('deflate-raw')));
  const unpack = async (text) =>
      new TextDecoder().decode(await through(to_bytes(text), new DecompressionStream('deflate-raw')));

  /** {name: text} as an address part, and back. */
  const write = (values) =>
      '#' + new URLSearchParams(Object.entries(values).filter(([, value]) => value !== null && value !== undefined))
                .toString();
  const read = () => Object.fromEntries(new URLSearchParams(location.hash.slice(1)));

  return {pack, unpack, write, read};
})();
