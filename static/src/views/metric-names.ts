// What the field calls the quantities of metrics: HOTA, CLEAR and identity as TrackEval prints
// them, the others in words.

import { words } from "../format";

const NAMES: Record<string, Record<string, string>> = {
  hota: {
    ...{
      hota: "HOTA",
      det_a: "DetA",
      ass_a: "AssA",
      loc_a: "LocA",
      det_re: "DetRe",
      det_pr: "DetPr",
      ass_re: "AssRe",
      ass_pr: "AssPr",
    },
    ...{
      owta: "OWTA",
      hota_0: "HOTA(0)",
      loc_a_0: "LocA(0)",
      hota_loc_a_0: "HOTALocA(0)",
      tp: "HOTA_TP",
      fn: "HOTA_FN",
      fp: "HOTA_FP",
    },
  },
  clear: {
    ...{
      mota: "MOTA",
      moda: "MODA",
      motp_similarity: "MOTP",
      motp_distance: "MOTP as a distance",
      smota: "sMOTA",
      motal: "MOTAL",
    },
    ...{
      recall: "CLR_Re",
      precision: "CLR_Pr",
      f1: "CLR_F1",
      tp: "CLR_TP",
      fn: "CLR_FN",
      fp: "CLR_FP",
      fp_per_step: "FP_per_frame",
    },
    ...{
      idsw: "IDSW",
      frag: "Frag",
      frag_trackeval: "Frag of TrackEval",
      mt: "MT",
      pt: "PT",
      ml: "ML",
    },
    ...{ mt_share: "MTR", pt_share: "PTR", ml_share: "MLR" },
  },
  identity: { idf1: "IDF1", idp: "IDP", idr: "IDR", idtp: "IDTP", idfn: "IDFN", idfp: "IDFP" },
};

const TITLES: Record<string, string> = { hota: "HOTA" };

/** Curves that count; the others of these metrics are shares. */
const COUNTS: Record<string, string[]> = { hota: ["tp", "fn", "fp"] };

/** A metric that is listed twice has a number behind its name. */
const plain = (metric: string): string => metric.replace(/_\d+$/, "");

export function quantityName(metric: string, quantity: string): string {
  return NAMES[plain(metric)]?.[quantity] ?? words(quantity);
}

export function metricTitle(metric: string): string {
  return (
    TITLES[plain(metric)]?.concat(metric.slice(plain(metric).length).replace("_", " ")) ?? metric
  );
}

export function isCount(metric: string, curve: string): boolean {
  return COUNTS[plain(metric)]?.includes(curve) ?? false;
}

export function isOfShares(metric: string): boolean {
  return plain(metric) in COUNTS;
}
