// The part of the page that needs three.js; it comes behind the first view.
export { loadFiles } from './load';
export { Model } from './model';
export { Viewer, type Layout, type Look, type Side } from './viewer';
