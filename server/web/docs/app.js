'use strict';

// Shows /openapi.json, and sends requests from it. All text goes in as text, never as markup.

const shownText = 20000; // characters of an answer

function el(name, properties, ...children) {
  const node = document.createElement(name);
  const { data, ...rest } = properties || {};
  Object.assign(node, rest);
  for (const [key, value] of Object.entries(data || {})) node.setAttribute(key, value);
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

function pretty(value) {
  return JSON.stringify(value, null, 2);
}

// What a "$ref" leads to; members beside it are kept.
function resolved(api, value) {
  if (!value || typeof value.$ref !== 'string' || !value.$ref.startsWith('#/')) return value;
  let target = api;
  for (const key of value.$ref.slice(2).split('/')) {
    target = target && target[key.replace(/~1/g, '/').replace(/~0/g, '~')];
  }
  const { $ref, ...beside } = value;
  return { ...resolved(api, target), ...beside };
}

// A text with its `code`.
function inline(text) {
  return (text || '').split('`').map((piece, i) => (i % 2 ? el('code', { textContent: piece }) : piece));
}

// Paragraphs of a description.
function prose(text) {
  const box = el('div');
  for (const paragraph of (text || '').trim().split(/\n\s*\n/)) {
    if (!paragraph) continue;
    box.append(el('p', {}, ...inline(paragraph)));
  }
  return box;
}

function typeText(api, given) {
  const schema = resolved(api, given) || {};
  if ('const' in schema) return JSON.stringify(schema.const);
  if (schema.enum) return schema.enum.map((value) => JSON.stringify(value)).join(', ');
  if (schema.anyOf) return schema.anyOf.map((one) => typeText(api, one)).join(' or ');
  let text = [].concat(schema.type || 'any').join(' or ');
  if (schema.type === 'array') text = `list of ${typeText(api, schema.items || {})}`;
  if ('minimum' in schema || 'maximum' in schema) {
    text += ` ${schema.minimum ?? ''} … ${schema.maximum ?? ''}`;
  }
  return text;
}

function table(head, rows) {
  const cells = (values, name) => values.map((value) => el(name, {}, value));
  return el('div', { className: 'scroll' }, el('table', {},
    el('thead', {}, el('tr', {}, ...cells(head, 'th'))),
    el('tbody', {}, ...rows.map((row) => el('tr', {}, ...cells(row, 'td'))))));
}

// One row for each member of an object, those of inner objects after it.
function memberRows(api, given, before, depth) {
  const schema = resolved(api, given) || {};
  const rows = [];
  for (const [name, inner] of Object.entries(schema.properties || {})) {
    const member = resolved(api, inner);
    const needed = (schema.required || []).includes(name) ? '' : ' (optional)';
    const notes = [member.description || ''];
    if (member['x-unit']) notes.push(`Unit: ${member['x-unit']}.`);
    if ('default' in member) notes.push(`Default: ${JSON.stringify(member.default)}.`);
    rows.push([el('code', { textContent: before + name }), typeText(api, member) + needed, notes.join(' ')]);
    if (depth === 0) continue;
    for (const one of [member, member.items, ...(member.anyOf || [])]) {
      const target = one && (resolved(api, one).type === 'array' ? resolved(api, one).items : one);
      if (target && target.properties) rows.push(...memberRows(api, target, `${before}${name}.`, depth - 1));
    }
  }
  return rows;
}

function examplesOf(api, media) {
  const found = [];
  for (const [name, given] of Object.entries((media && media.examples) || {})) {
    const example = resolved(api, given);
    found.push(el('h3', { textContent: example.summary ? `${name}: ${example.summary}` : name }),
      el('pre', { textContent: pretty(example.value) }));
  }
  return found;
}

function schemaLink(schema) {
  const name = schema && schema.$ref && schema.$ref.split('/').pop();
  return name ? el('a', { href: `#schema-${name}`, textContent: name }) : '';
}

function responseBox(api, status, given) {
  const response = resolved(api, given);
  const box = el('details', {},
    el('summary', {}, el('strong', { textContent: status, className: status < '400' ? 'good' : 'bad' }),
      ' ', ...inline(response.description)));
  const headers = Object.entries(response.headers || {});
  if (headers.length > 0) {
    box.append(table(['header', 'meaning'], headers.map(([name, header]) =>
      [el('code', { textContent: name }), prose(resolved(api, header).description)])));
  }
  for (const [type, media] of Object.entries(response.content || {})) {
    box.append(el('p', {}, el('code', { textContent: type }), ' ', schemaLink(media.schema)), ...examplesOf(api, media));
    const events = Object.entries(media['x-events'] || {});
    if (events.length > 0) {
      box.append(table(['event', 'data'], events.map(([name, schema]) => [el('code', { textContent: name }), schemaLink(schema)])));
    }
  }
  return box;
}

function schemaOf(parameter) {
  return parameter.schema || Object.values(parameter.content || {})[0].schema;
}

function parameterTable(api, parameters) {
  return table(['parameter', 'type', 'meaning'], parameters.map((parameter) => [
    el('code', { textContent: parameter.name }),
    `${parameter.in}, ${parameter.content ? 'JSON' : typeText(api, schemaOf(parameter))}`,
    prose(parameter.description)]));
}

function firstExample(api, parameter) {
  if ('example' in parameter && parameter.in === 'path') return '';
  const media = Object.values(parameter.content || {})[0];
  const example = media && Object.values(media.examples || {})[0];
  return example ? JSON.stringify(resolved(api, example).value) : '';
}

function fieldsOf(api, parameters) {
  return parameters.map((parameter) => {
    const long = Boolean(parameter.content);
    const input = el(long ? 'textarea' : 'input', {
      value: firstExample(api, parameter), required: Boolean(parameter.required) });
    if (long) input.rows = 3;
    const list = resolved(api, schemaOf(parameter)).type === 'array';
    const hint = list ? ', several with spaces between' : '';
    return { parameter, input, list, label: el('label', {}, `${parameter.name} (${parameter.in}${hint})`, input) };
  });
}

// The file fields of an operation with a body; several files, or any for a form, go as a form.
function bodyFields(body) {
  if (!body) return null;
  const types = Object.keys(body.content);
  const file = el('input', { type: 'file', multiple: true, required: Boolean(body.required) });
  const type = el('select', {}, ...types.map((name) => el('option', { textContent: name })));
  type.value = types.includes('application/octet-stream') ? 'application/octet-stream' : types[0];
  return { file, type, labels: [el('label', {}, 'Files', file), el('label', {}, 'Content-Type', type)] };
}

function urlOf(path, fields) {
  const query = new URLSearchParams();
  let url = path;
  for (const { parameter, input, list } of fields) {
    if (parameter.in === 'path') url = url.replace(`{${parameter.name}}`, encodeURIComponent(input.value));
    if (parameter.in !== 'query' || input.value === '') continue;
    for (const value of list ? input.value.trim().split(/\s+/) : [input.value]) query.append(parameter.name, value);
  }
  return [...query].length > 0 ? `${url}?${query}` : url;
}

function requestOf(method, fields, body) {
  const request = { method: method.toUpperCase(), headers: {} };
  const key = document.getElementById('key').value.trim();
  if (key) request.headers.Authorization = `Bearer ${key}`;
  for (const { parameter, input } of fields) {
    if (parameter.in === 'header' && input.value !== '') request.headers[parameter.name] = input.value;
  }
  if (!body || body.file.files.length === 0) return request;
  const files = [...body.file.files];
  if (files.length > 1 || body.type.value === 'multipart/form-data') {
    request.body = new FormData();
    for (const file of files) request.body.append(file.name, file, file.name);
  } else {
    request.headers['Content-Type'] = body.type.value;
    [request.body] = files;
  }
  return request;
}

// A stream of events is shown as it comes.
async function showStream(response, place) {
  const shown = el('pre');
  place.append(shown);
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  for (let piece = await reader.read(); !piece.done; piece = await reader.read()) {
    shown.textContent = (shown.textContent + piece.value).slice(-shownText);
  }
}

async function showAnswer(response, place) {
  const type = response.headers.get('Content-Type') || '';
  const head = [...response.headers].map(([name, value]) => `${name}: ${value}`).join('\n');
  place.append(el('p', {}, el('strong', { textContent: response.status, className: response.ok ? 'good' : 'bad' })),
    el('pre', { textContent: head }));
  if (!type) return;
  if (type === 'text/event-stream') {
    await showStream(response, place);
    return;
  }
  if (/json|^text\//.test(type) && !type.startsWith('model/')) {
    const text = await response.text();
    const shown = type.includes('json') ? pretty(JSON.parse(text)) : text;
    place.append(el('pre', { textContent: shown.slice(0, shownText) }));
    return;
  }
  const bytes = await response.blob();
  const name = /filename="([^"]+)"/.exec(response.headers.get('Content-Disposition') || '');
  place.append(el('p', {}, el('a', {
    href: URL.createObjectURL(bytes), download: name ? name[1] : 'answer',
    textContent: `Save ${bytes.size} bytes` })));
}

function tryBox(api, path, method, operation, parameters) {
  const fields = fieldsOf(api, parameters);
  const body = bodyFields(resolved(api, operation.requestBody));
  const answer = el('div', { data: { role: 'status' } });
  const form = el('form', {}, ...fields.map((field) => field.label), ...(body ? body.labels : []),
    el('button', { textContent: 'Send' }), answer);
  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    answer.replaceChildren('Waiting …');
    try {
      const response = await fetch(urlOf(path, fields), requestOf(method, fields, body));
      answer.replaceChildren();
      await showAnswer(response, answer);
    } catch (error) {
      answer.replaceChildren(el('p', { className: 'bad', textContent: String(error) }));
    }
  });
  return el('details', {}, el('summary', { textContent: 'Try it' }), form);
}

function operationBox(api, path, method, operation, shared) {
  const places = ['path', 'query', 'header'];
  const parameters = [...(operation.parameters || []), ...(shared || [])].map((one) => resolved(api, one))
    .sort((a, b) => places.indexOf(a.in) - places.indexOf(b.in));
  const body = resolved(api, operation.requestBody);
  const box = el('details', { id: operation.operationId },
    el('summary', {}, el('span', { className: 'method', textContent: method.toUpperCase() }),
      el('span', { className: 'path', textContent: path }), ' ',
      el('span', { className: 'what', textContent: operation.summary || '' })),
    prose(operation.description));
  for (const { key } of operation.security || []) {
    box.append(el('p', {}, ...inline(`Where keys are asked for it needs the scope \`${key.join(' ')}\`.`)));
  }
  if (parameters.length > 0) {
    box.append(parameterTable(api, parameters));
    for (const parameter of parameters) {
      const media = Object.values(parameter.content || {})[0];
      if (media) box.append(el('details', {}, el('summary', { textContent: `Examples of ${parameter.name}` }), ...examplesOf(api, media)));
    }
  }
  if (body) {
    box.append(el('h3', { textContent: 'Body' }), prose(body.description), el('p', { textContent: Object.keys(body.content).join(', ') }));
    for (const media of Object.values(body.content)) box.append(schemaLink(media.schema), ...examplesOf(api, media));
  }
  box.append(el('h3', { textContent: 'Answers' }),
    ...Object.entries(operation.responses).map(([status, response]) => responseBox(api, status, response)));
  if (path.startsWith('/')) box.append(tryBox(api, path, method, operation, parameters));
  return box;
}

function addOperations(api) {
  const place = document.getElementById('operations');
  const links = document.getElementById('sections');
  for (const tag of api.tags) {
    const section = el('section', { id: `tag-${tag.name}` }, el('h2', { textContent: tag.name }), prose(tag.description));
    for (const [path, item] of Object.entries(api.paths)) {
      for (const method of ['options', 'head', 'get', 'post', 'put', 'patch', 'delete']) {
        const operation = item[method];
        if (!operation || !operation.tags.includes(tag.name)) continue;
        section.append(operationBox(api, path, method, operation, item.parameters));
      }
    }
    place.append(section);
    links.append(el('li', {}, el('a', { href: `#${section.id}`, textContent: tag.name })));
  }
  const section = el('section', { id: 'webhooks' }, el('h2', { textContent: 'Webhooks' }), el('p', { textContent: 'What the service sends.' }));
  for (const [name, item] of Object.entries(api.webhooks)) section.append(operationBox(api, name, 'post', item.post, []));
  place.append(section);
  links.append(el('li', {}, el('a', { href: '#webhooks', textContent: 'Webhooks' })),
    el('li', {}, el('a', { href: '#choices', textContent: 'Parameters' })),
    el('li', {}, el('a', { href: '#schemas', textContent: 'Schemas' })));
}

function addSchemas(api) {
  const place = document.getElementById('schemas');
  place.append(el('h2', { textContent: 'Schemas' }));
  for (const [name, schema] of Object.entries(api.components.schemas)) {
    const rows = memberRows(api, schema, '', 0);
    place.append(el('details', { id: `schema-${name}` }, el('summary', {}, el('code', { textContent: name })),
      prose(schema.description), rows.length > 0 ? table(['member', 'type', 'meaning'], rows) : el('p', { textContent: typeText(api, schema) })));
  }
}

function addChoices(api, catalog) {
  const place = document.getElementById('choices');
  place.append(el('h2', { textContent: 'Methods' }),
    table(['method', 'equation', 'good for', 'choose'], catalog.methods.map((method) => [
      el('code', { textContent: method.name }), method.equation, method.good_for, method.choose_when])),
    el('h2', { textContent: 'Presets' }),
    table(['preset', 'for', 'values'], catalog.presets.map((preset) => [
      el('code', { textContent: preset.name }), preset.description, el('code', { textContent: JSON.stringify(preset.parameters) })])),
    el('h2', { textContent: 'Parameters' }),
    table(['parameter', 'values', 'meaning'], memberRows(api, catalog.parameters, '', 1)));
}

async function json(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url} is answered ${response.status}.`);
  return response.json();
}

// What a link leads to is shown, where it is folded, too.
function openTarget() {
  const target = document.getElementById(window.location.hash.slice(1));
  if (!target) return;
  target.open = true;
  target.scrollIntoView();
}

async function start() {
  const status = document.getElementById('status');
  try {
    const [api, catalog] = await Promise.all([json('/openapi.json'), json('/v1/methods')]);
    document.getElementById('title').textContent = `${api.info.title} ${api.info.version}`;
    document.getElementById('summary').textContent = api.info.summary;
    document.getElementById('about').append(prose(api.info.description));
    addOperations(api);
    addChoices(api, catalog);
    addSchemas(api);
    status.remove();
    openTarget();
  } catch (error) {
    status.textContent = `The contract cannot be shown. ${error.message}`;
    status.className = 'bad';
  }
}

window.addEventListener('hashchange', openTarget);
start();
