// What the bundler puts in.
declare const FAIRWAY_VERSION: string;
declare const DRACO_PATH: string;
declare const COARSE_WORKER: string;
