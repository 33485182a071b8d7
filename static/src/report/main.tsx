// The page of one job as a file: it reads the data that stand in it, and asks nobody.

import { render } from "preact";
import type { Data } from "./data";
import { ReportPage } from "./page";

const root = document.getElementById("app");
const text = document.getElementById("data")?.textContent ?? "";
if (root) render(<ReportPage data={JSON.parse(text) as Data} />, root);
