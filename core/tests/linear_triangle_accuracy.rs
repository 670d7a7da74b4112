#![allow(clippy::disallowed_methods, reason = "truth in f64")]
use etendue_core::sampling::linear_triangle as lt;
struct R(u64);
impl R { fn n(&mut self)->u64{ self.0=self.0.wrapping_add(0x9E37_79B9_7F4A_7C15); let mut z=self.0; z=(z^(z>>30)).wrapping_mul(0xBF58_476D_1CE4_E5B9); z=(z^(z>>27)).wrapping_mul(0x94D0_49BB_1331_11EB); z^(z>>31)}
 fn f(&mut self)->f64{(self.n()>>11) as f64/(1u64<<53) as f64}
 fn b(&mut self,n:u64)->u64{self.n()%n}}
fn truth(w:[f64;3],xi:f64)->[f64;2]{
 let s=w[0]+w[1]+w[2]; let t=(w[1]-w[0])+(w[2]-w[0]); let v=w[1]+w[2];
 // bisection-safe Newton from above for s
 let p=|x:f64| x*x*(3.0*w[0]+t*x)/s;
 let q=|c:f64| c*(3.0*v-3.0*(v-w[0])*c+t*c*c)/s;
 if xi==0.0 {return [0.0,1.0];}
 let far = xi>p(0.5);
 if !far { let mut x=xi.cbrt().min(1.0); for _ in 0..100 { let d=(p(x)-xi)*s/(x*(6.0*w[0]+3.0*t*x)); x-=d; if d.abs()<=x*1e-16 {break;} } [x,1.0-x] }
 else { let r=1.0-xi; let mut c=r*0.3; for _ in 0..100 { let d=(q(c)-r)*s/(3.0*v-6.0*(v-w[0])*c+3.0*t*c*c); c-=d; if d.abs()<=c*1e-16 {break;} } [1.0-c,c] }
}
fn weights(r:&mut R)->[f32;3]{
 let base=2.0f64.powf(r.f()*250.0-125.0);
 let mut w=match r.b(8){
  0=>[1.0;3],
  1=>[1.0+1e-7*r.f(),1.0+1e-7*r.f(),1.0+1e-7*r.f()],
  2=>[0.0,0.0,1.0],
  3=>[0.0,r.f(),r.f()],
  4=>[1.0,10f64.powf(-30.0*r.f()),10f64.powf(-30.0*r.f())],
  5=>{let x=10f64.powf(-30.0*r.f());[1.0,x,x]},
  6=>[r.f(),r.f(),r.f()],
  _=>{let e=10f64.powf(-8.0*r.f());[1.0,1.0+e*r.f(),1.0+e*r.f()]}
 };
 let k=r.b(3) as usize; w.rotate_left(k);
 w.map(|x|(x*base) as f32)
}
fn unit(r:&mut R)->f32{ match r.b(8){0=>0.0,1=>f32::from_bits(1),2=>1.0-1.0/16777216.0,3=>2f64.powf(-149.0*r.f()) as f32,4=>(1.0-2f64.powf(-24.0*r.f())) as f32,_=>(r.n()>>40) as f32/16777216.0}}
#[test] fn proto(){
 let n:u64=std::env::var("N").ok().and_then(|s|s.parse().ok()).unwrap_or(1_000_000);
 let mut r=R(1); let mut worst=[0.0f64;5]; let mut at=[([0.0f32;3],[0.0f32;2]);5];
 for _ in 0..n { let w=weights(&mut r); let u=[unit(&mut r),unit(&mut r)];
  let (k,[s,c])=lt::apex_distance(w,u[0]);
  let wd=[0,1,2].map(|i| f64::from(w[(k+i)%3]));
  let m=wd[1].max(wd[2]); let wd=wd.map(|x|x/m);
  let [ts,tc]=truth(wd,f64::from(u[0]));
  let rel=|x:f64,t:f64| if x==t {0.0} else {(x-t).abs()/t*8388608.0};
  let b=lt::sample(w,u); let b=[0,1,2].map(|i| f64::from(b[(k+i)%3]));
  let e=f64::from(u[1]); let (a,bb)=(wd[0]*tc+wd[1]*ts,wd[0]*tc+wd[2]*ts);
  let d=(a*a*(1.0-e)+bb*bb*e).sqrt(); let t= if e*(a+bb)==0.0 {0.0} else {e*(a+bb)/(a+d)}; let t1= if (1.0-e)*(a+bb)==0.0 {1.0-t} else {(1.0-e)*(a+bb)/(bb+d)};
  let es=[rel(f64::from(s),ts),rel(f64::from(c),tc),rel(b[1]+b[2],ts)*if ts>1e-35{1.0}else{0.0}, (rel(b[1],ts*t1).max(rel(b[2],ts*t)))*if (ts*t1).min(ts*t)>1e-37 {1.0} else {0.0},(b[0]+b[1]+b[2]-1.0).abs()*8388608.0];
  for i in 0..5 { if !(es[i]<=worst[i]) {worst[i]=if es[i].is_nan(){1e300}else{es[i]}; at[i]=(w,u);} }
 }
 for i in 0..5 {println!("{i} {:e} {:?}",worst[i],at[i]);}
}
