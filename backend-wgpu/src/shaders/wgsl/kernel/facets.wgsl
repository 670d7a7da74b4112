//: use kernel::words
//: use bsdf::facets

fn kernel_facets_facets() -> Facets {
    let beckmann = word() != 0u;
    return facets_new(float(), beckmann);
}

fn kernel_facets_density() {
    let facets = kernel_facets_facets();
    let n = triple();
    put(facets_density(facets, n, triple()));
}

fn kernel_facets_masking() {
    let facets = kernel_facets_facets();
    let n = triple();
    put(facets_masking(facets, n, triple()));
}

fn kernel_facets_pdf_visible() {
    let facets = kernel_facets_facets();
    let n = triple();
    let wo = triple();
    put(facets_pdf_visible(facets, n, wo, triple()));
}

fn kernel_facets_sample_visible() {
    let facets = kernel_facets_facets();
    let n = triple();
    let wo = triple();
    put3(facets_sample_visible(facets, n, wo, pair()));
}
