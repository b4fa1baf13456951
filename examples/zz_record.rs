use bekker::script::*;
fn main() {
    for f in std::env::args().skip(1) {
        let p = std::path::Path::new(&f);
        let s = Script::read_to_record(p).unwrap();
        let r = drive(&s, &mut Core::new(&s)).unwrap();
        println!("{} {} {:?}", s.name, r.status, r.times.last());
        if f.contains("sinks") {
            println!("{}", Script::read(p).unwrap().check(&mut Core::new(&s)).map(|r| r.to_string()).unwrap());
        } else {
            println!("{:?}", s.write_expected(&r));
        }
    }
}
