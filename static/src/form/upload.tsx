// The form of an upload, loaded when somebody uploads.

import { later } from "../components/later";

export const Upload = later("the form", async () => (await import("../upload/panel")).Panel);
