declare const FAIRWAY_VERSION: string; declare const DRACO_PATH: string; console.log(FAIRWAY_VERSION, DRACO_PATH);
