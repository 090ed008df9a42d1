// Finds the place that a mistake names in the text of a JSON document, and where its syntax is wrong.

const space = /[ \t\r\n]*/y, text = /"(?:[^"\\\u0000-\u001f]|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*"/y;
const plain = /-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?\d+)?|true|false|null/y;

// The place {start, end, keyStart} of each value, by its path as the farm writes it: "scene.media[0].g".
function scan(source) {
  const places = new Map();
  let at = 0;
  const take = (pattern) => {
    pattern.lastIndex = at;
    const match = pattern.exec(source);
    if (match) at = pattern.lastIndex;
    return match?.[0];
  };
  const mistake = (message, place) => Object.assign(new SyntaxError(message), { at: place });
  const fail = (expected) => {
    throw mistake(`expected ${expected}, got ${at < source.length ? JSON.stringify(source[at]) : "the end"}`, at);
  };
  const members = (end, one) => {
    at++;
    take(space);
    if (source[at] === end) return at++;
    for (let i = 0; ; i++) {
      one(i);
      take(space);
      if (source[at] === end) return at++;
      if (source[at] !== ",") fail(`"," or "${end}"`);
      at++;
      take(space);
    }
  };
  const value = (path, keyStart) => {
    take(space);
    const start = at;
    if (source[at] === "{") {
      const keys = new Set();
      members("}", () => {
        const keyAt = at, key = take(text) ?? fail("a key in quotes"), name = JSON.parse(key);
        if (keys.has(name)) throw mistake(`the key ${key} appears twice`, keyAt);
        keys.add(name);
        take(space);
        if (source[at] !== ":") fail('":"');
        at++;
        value(path ? `${path}.${name}` : name, keyAt);
      });
    } else if (source[at] === "[") members("]", (i) => value(`${path}[${i}]`));
    else take(text) ?? take(plain) ?? fail("a value");
    places.set(path, { start, end: at, keyStart: keyStart ?? start });
  };
  value("");
  take(space);
  if (at < source.length) fail("the end");
  return places;
}

// Where the syntax is wrong: {at, message}, or null.
export function findSyntaxMistake(source) {
  try {
    scan(source);
    return null;
  } catch (mistake) {
    if (mistake.at === undefined) throw mistake;
    return mistake;
  }
}

// "params.document.scene.media[0].g: expected ..." in parts.
export function splitMessage(message) {
  const match = /^(?:params\.)?document(?:\.?((?:[^:"\s])+))?: (.*)$/s.exec(message);
  return match ? { path: match[1] ?? "", text: match[2] } : { path: null, text: message };
}

// The part [start, end) of the text that a message of the farm is about; null where it names none. Of what is absent
// it is the nearest object around it, of an unknown key the key.
export function findPlace(source, message) {
  let { path, text: said } = splitMessage(message);
  if (path === null) return null;
  const places = scan(source), unknown = /^unknown key "([^"]*)"/.exec(said);
  const key = unknown && places.get(path ? `${path}.${unknown[1]}` : unknown[1]);
  if (key) return { start: key.keyStart, end: key.end };
  while (path && !places.has(path)) path = path.replace(/(^|\.|)[^.[\]]*$|\[[^\]]*\]$/, "");
  const { start, end, keyStart } = places.get(path);
  return { start: path ? keyStart : start, end: path ? end : start + 1 };
}
