// Small steps with the document. Text from the network goes through textContent alone.

/** @param text   content, or children when it is an array. */
export function element(tag, class_name = "", text = "") {
  const made = document.createElement(tag);
  if (class_name) made.className = class_name;
  if (Array.isArray(text)) made.append(...text); else if (text) made.textContent = text;
  return made;
}

/** Sets a text only where it differs, so that nothing is laid out anew without need. */
export function set_text(target, text) {
  if (target.textContent !== text) target.textContent = text;
}

export function set_hidden(target, is_hidden) {
  if (target.hidden !== is_hidden) target.hidden = is_hidden;
}

/**
 * Makes the children of a list one for each item, in their order; those of known items stay.
 * @param key_of   text that names an item; `make(item)` gives a child, `update(child, item)` fills it.
 */
export function keep_children(list, items, key_of, make, update) {
  const present = new Map([...list.children].map((child) => [child.dataset.key, child]));
  items.forEach((item, i) => {
    const key = key_of(item);
    let child = present.get(key);
    present.delete(key);
    if (child === undefined) {
      child = make(item);
      child.dataset.key = key;
    }
    if (list.children[i] !== child) list.insertBefore(child, list.children[i] ?? null);
    update(child, item);
  });
  for (const child of present.values()) child.remove();
}
